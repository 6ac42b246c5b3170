#!/usr/bin/env python3
"""report.html of a run in headless Chromium, with real clicks, on a desk and on a phone.

Usage: report_browser_test.py PLANECAST WORK_FOLDER [unittest arguments]
Needs chromium-driver and python3-selenium (scripts/test_full.sh installs them).
"""

import re
import shutil
import sys
import time
import unittest

from cli import WORK, empty_work_folder, planecast

if not shutil.which("chromedriver"):
    print("chromedriver is not installed (scripts/test_full.sh installs them)")
    sys.exit(77)

from selenium import webdriver
from selenium.webdriver.common.action_chains import ActionChains
from selenium.webdriver.common.by import By
from selenium.webdriver.common.keys import Keys
from selenium.webdriver.chrome.service import Service

FRAMES = 60
DESK = (1280, 900)
PHONE = (390, 844)


def setUpModule():
    empty_work_folder()
    planecast("synth", "tabletop", "-o", WORK / "tabletop", "--width", 320, "--height", 240,
              "--count", FRAMES, "--quiet")
    for name in ("one", "two"):
        planecast("run", WORK / "tabletop", "--mode", "rgbd", "-o", WORK / name, "--quiet")


def without_times(html):
    """What must be the same bytes; the command names the output folder."""
    html = re.sub(r"<!-- times: .*<!-- end of times -->", "", html, flags=re.DOTALL)
    return html.replace(str(WORK / "two"), str(WORK / "one"))


class SameBytes(unittest.TestCase):
    def test_reports_differ_in_their_times_alone(self):
        one, two = ((WORK / name / "report.html").read_text() for name in ("one", "two"))
        self.assertNotEqual(one, two)
        self.assertEqual(without_times(one), without_times(two))


class Page(unittest.TestCase):
    """A browser of the class's size with the report open."""

    size = DESK
    dark = False

    def setUp(self):
        options = webdriver.ChromeOptions()
        for argument in ("--headless=new", "--no-sandbox", "--use-gl=angle",
                         "--use-angle=swiftshader", "--enable-unsafe-swiftshader",
                         "--hide-scrollbars", "--force-device-scale-factor=1"):
            options.add_argument(argument)
        if self.dark:
            options.add_argument("--blink-settings=preferredColorScheme=0")
        options.set_capability("goog:loggingPrefs", {"browser": "ALL", "performance": "ALL"})
        self.page = webdriver.Chrome(service=Service(shutil.which("chromedriver")), options=options)
        self.addCleanup(self.page.quit)
        width, height = self.size
        self.page.execute_cdp_cmd("Emulation.setDeviceMetricsOverride", {
            "width": width, "height": height, "deviceScaleFactor": 1, "mobile": width < 500})
        self.page.get((WORK / "one" / "report.html").as_uri())
        self.wait_for(lambda: self.find("#readout").text)

    def find(self, selector):
        return self.page.find_element(By.CSS_SELECTOR, selector)

    def wait_for(self, condition, seconds=20):
        end = time.monotonic() + seconds
        while not condition():
            if time.monotonic() > end:
                self.fail("the page did not get there")
            time.sleep(0.1)

    def show(self, element):
        self.page.execute_script("arguments[0].scrollIntoView({block: 'center'})", element)
        time.sleep(0.3)
        return element

    def messages(self):
        return [entry for entry in self.page.get_log("browser") if entry["level"] != "INFO"]

    def addresses_asked_for(self):
        found = []
        for entry in self.page.get_log("performance"):
            match = re.search(r'"requestWillBeSent".*?"url":"([^"]*)"', entry["message"])
            if match:
                found.append(match.group(1))
        return found

    def frame(self):
        return int(self.find("#frame").get_attribute("value"))


class Desk(Page):
    def test_nothing_is_loaded_from_outside_and_nothing_goes_wrong(self):
        time.sleep(1.0)
        self.assertEqual(self.messages(), [])
        outside = [a for a in self.addresses_asked_for()
                   if not a.startswith(("data:", "blob:", "file:"))]
        self.assertEqual(outside, [])
        files = [a for a in self.addresses_asked_for() if a.startswith("file:")]
        self.assertEqual({f.rsplit("/", 1)[-1] for f in files} - {"favicon.ico"}, {"report.html"})

    def test_the_map_turns_when_dragged(self):
        canvas = self.show(self.find("#map canvas"))
        before = canvas.screenshot_as_png
        again = canvas.screenshot_as_png
        self.assertEqual(before, again, "the map moves by itself")
        ActionChains(self.page).drag_and_drop_by_offset(canvas, 120, 30).perform()
        time.sleep(0.5)
        self.assertNotEqual(canvas.screenshot_as_png, before)
        self.page.find_element(By.XPATH, "//button[text()='Reset view']").click()
        time.sleep(0.5)
        self.assertEqual(canvas.screenshot_as_png, before)

    def test_the_map_turns_by_keys_and_zooms_by_the_wheel(self):
        canvas = self.show(self.find("#map canvas"))
        before = canvas.screenshot_as_png
        self.page.execute_script("arguments[0].focus({preventScroll: true})", canvas)
        ActionChains(self.page).send_keys(Keys.ARROW_LEFT).perform()
        time.sleep(0.5)
        turned = canvas.screenshot_as_png
        self.assertNotEqual(turned, before)
        ActionChains(self.page).scroll_from_origin(
            webdriver.common.actions.wheel_input.ScrollOrigin.from_element(canvas), 0, -200).perform()
        time.sleep(0.5)
        self.assertNotEqual(canvas.screenshot_as_png, turned)

    def test_layers_of_the_map_can_be_hidden(self):
        canvas = self.show(self.find("#map canvas"))
        for name in ("Points", "Planes", "Path", "Objects"):
            before = canvas.screenshot_as_png
            button = self.page.find_element(By.XPATH, f"//button[text()='{name}']")
            button.click()
            time.sleep(0.4)
            self.assertEqual(button.get_attribute("aria-pressed"), "false")
            self.assertNotEqual(canvas.screenshot_as_png, before, name)

    def test_a_click_into_a_chart_moves_everything_to_that_frame(self):
        plot = self.show(self.find("#chart-inliers .plot"))
        ActionChains(self.page).move_to_element_with_offset(plot, plot.rect["width"] // 4, 0) \
            .click().perform()
        self.wait_for(lambda: abs(self.frame() - 45) <= 1)
        self.assertIn(f"{self.frame()} ·", self.find("#readout").text)
        self.assertIn("inliers", self.find("#readout").text)
        # The video follows; its pictures are 1/30 s long.
        position = "return Math.floor(document.getElementById('video').currentTime * 30)"
        self.wait_for(lambda: self.page.execute_script(position) == self.frame())

    def test_the_video_plays_and_takes_the_cursors_with_it(self):
        self.wait_for(lambda: self.page.execute_script("return video.readyState") >= 2)
        seconds = self.page.execute_script("return video.duration")
        self.assertAlmostEqual(seconds, FRAMES / 30, delta=0.05)
        self.page.execute_script("video.play()")
        self.wait_for(lambda: self.frame() > 5)

    def test_charts_show(self):
        for chart in ("#chart-inliers", "#chart-times"):
            plot = self.show(self.find(f"{chart} .plot"))
            self.assertGreater(plot.rect["height"], 100)
            self.assertGreater(len(plot.find_elements(By.CSS_SELECTOR, ".tick")), 1)
            self.assertGreater(len(plot.find_elements(By.CSS_SELECTOR, "path")), 2)
        self.assertGreater(len(self.page.find_elements(By.CSS_SELECTOR, "#planes tr[data-plane]")), 1)

    def test_a_plane_of_the_table_is_shown_in_the_map(self):
        canvas = self.show(self.find("#map canvas"))
        before = canvas.screenshot_as_png
        self.show(self.find("#planes tr[data-plane]")).click()
        self.show(canvas)
        self.assertNotEqual(canvas.screenshot_as_png, before)

    def test_pictures_for_the_eye(self):
        """Not checked; left in the work folder to be looked at."""
        height = self.page.execute_script("return document.documentElement.scrollHeight")
        self.page.execute_cdp_cmd("Emulation.setDeviceMetricsOverride", {
            "width": self.size[0], "height": height, "deviceScaleFactor": 1, "mobile": False})
        time.sleep(1.0)
        name = f"{type(self).__name__.lower()}.png"
        self.assertTrue(self.page.save_screenshot(str(WORK / name)))


class DarkDesk(Desk):
    dark = True

    def test_the_page_is_dark(self):
        paper = self.page.execute_script("return getComputedStyle(document.body).backgroundColor")
        self.assertLess(sum(map(int, re.findall(r"\d+", paper))), 150, paper)


class Phone(Page):
    size = PHONE

    def test_nothing_is_wider_than_the_screen(self):
        wide = self.page.execute_script("return document.documentElement.scrollWidth")
        self.assertLessEqual(wide, PHONE[0])

    def test_words_are_large_enough_to_read(self):
        smallest = self.page.execute_script(
            "return Math.min(...[...document.querySelectorAll('main *')].filter(e => e.innerText)"
            ".map(e => parseFloat(getComputedStyle(e).fontSize)))")
        self.assertGreaterEqual(smallest, 11.0)

    def test_nothing_goes_wrong(self):
        time.sleep(1.0)
        self.assertEqual(self.messages(), [])

    def test_the_map_turns_under_a_finger(self):
        canvas = self.show(self.find("#map canvas"))
        before = canvas.screenshot_as_png
        box = canvas.rect
        top = self.page.execute_script("return window.scrollY")
        x, y = box["x"] + box["width"] / 2, box["y"] - top + box["height"] / 2
        touch = lambda kind, points: self.page.execute_cdp_cmd(
            "Input.dispatchTouchEvent", {"type": kind, "touchPoints": points})
        touch("touchStart", [{"x": x, "y": y}])
        for step in range(1, 11):
            touch("touchMove", [{"x": x + 8 * step, "y": y}])
        touch("touchEnd", [])
        time.sleep(0.5)
        self.assertNotEqual(canvas.screenshot_as_png, before)

    test_pictures_for_the_eye = Desk.test_pictures_for_the_eye


if __name__ == "__main__":
    unittest.main(argv=[sys.argv[0], *sys.argv[3:]])
