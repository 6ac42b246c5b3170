#!/usr/bin/env python3
"""The inspector's window under Xvfb, with real clicks and keys.

Usage: inspect_window_test.py PLANECAST WORK_FOLDER [unittest arguments]
Needs xvfb and xdotool (scripts/test_full.sh installs them).
"""

import os
import shutil
import subprocess
import sys
import time
import unittest

from cli import PLANECAST, ROOT, WORK, empty_work_folder, planecast

if not shutil.which("Xvfb") or not shutil.which("xdotool"):
    print("Xvfb or xdotool is not installed (scripts/test_full.sh installs them)")
    sys.exit(77)

TABLETOP = WORK / "tabletop"
SIZE = (1000, 640)
# By engine/inspect/window.cc: the picture takes 62 % of the width.
PICTURE_MIDDLE = (310, 330)
MAP_MIDDLE = (810, 200)


def setUpModule():
    empty_work_folder()
    planecast("synth", "tabletop", "-o", TABLETOP, "--width", 320, "--height", 240, "--count", 20,
              "--quiet")
    planecast("track", TABLETOP, "-o", WORK / "map", "--mode", "rgbd", "--quiet")


def start_display():
    """An X server on a number of its own choice."""
    read, write = os.pipe()
    server = subprocess.Popen(["Xvfb", "-displayfd", str(write), "-screen", "0", "1280x800x24",
                               "-nolisten", "tcp"], pass_fds=[write], stderr=subprocess.DEVNULL)
    os.close(write)
    with os.fdopen(read) as pipe:
        number = pipe.readline().strip()
    return server, f":{number}"


class Window(unittest.TestCase):
    def setUp(self):
        self.server, self.display = start_display()
        self.addCleanup(self.stop, self.server)
        self.scene = WORK / "map" / "scene.yaml"
        self.scene.unlink(missing_ok=True)
        self.inspector = subprocess.Popen(
            [str(PLANECAST), "inspect", str(WORK / "map"), "--sequence", str(TABLETOP), "--size",
             f"{SIZE[0]}x{SIZE[1]}"], cwd=ROOT,
            env={**os.environ, "DISPLAY": self.display}, stderr=subprocess.PIPE, text=True)
        self.addCleanup(self.stop, self.inspector)
        self.window = self.wait_for(self.find_window)
        self.wait_for(lambda: self.colors() > 50)

    @staticmethod
    def stop(process):
        process.terminate()
        process.wait(timeout=20)
        if process.stderr:
            process.stderr.close()

    def xdotool(self, *arguments):
        return subprocess.run(["xdotool", *map(str, arguments)], capture_output=True, text=True,
                              env={**os.environ, "DISPLAY": self.display}, timeout=60)

    def find_window(self):
        found = self.xdotool("search", "--name", "Planecast").stdout.split()
        return found[0] if found else None

    def wait_for(self, condition, seconds=60):
        end = time.monotonic() + seconds
        while True:
            value = condition()
            if value:
                return value
            if self.inspector.poll() is not None:
                self.fail(self.inspector.stderr.read())
            if time.monotonic() > end:
                self.screen("failed")
                self.fail("the window did not get there; see failed.png")
            time.sleep(0.2)

    def screen(self, name="screen"):
        """The display as PNG."""
        path = WORK / f"{name}.png"
        subprocess.run(["ffmpeg", "-v", "error", "-y", "-f", "x11grab", "-video_size", "1280x800",
                        "-i", self.display, "-frames:v", "1", str(path)], check=True)
        return path

    def pixels(self):
        """The display as raw bytes."""
        return subprocess.run(["ffmpeg", "-v", "error", "-f", "x11grab", "-video_size",
                               "1280x800", "-draw_mouse", "0", "-i", self.display, "-frames:v",
                               "1", "-pix_fmt", "rgb24", "-f", "rawvideo", "-"],
                              check=True, capture_output=True).stdout

    def colors(self):
        data = self.pixels()
        return len({data[i:i + 3] for i in range(0, len(data), 3 * 101)})

    def click(self, at, button=1):
        self.xdotool("mousemove", "--window", self.window, *at)
        time.sleep(0.5)
        self.xdotool("mousedown", button)
        time.sleep(0.5)
        self.xdotool("mouseup", button)
        time.sleep(0.5)

    def key(self, name):
        self.xdotool("key", "--window", self.window, "--delay", "1", name)
        time.sleep(0.5)

    def drag(self, start, end):
        self.xdotool("mousemove", "--window", self.window, *start)
        time.sleep(0.5)
        self.xdotool("mousedown", 1)
        time.sleep(0.5)
        for i in range(1, 6):
            self.xdotool("mousemove", "--window", self.window,
                         *(round(a + (b - a) * i / 5) for a, b in zip(start, end)))
            time.sleep(0.4)
        self.xdotool("mouseup", 1)
        time.sleep(0.5)

    def focus(self):
        self.xdotool("windowfocus", self.window)
        time.sleep(0.3)

    def test_place_drag_and_save_by_mouse_and_keys(self):
        self.focus()
        self.key("p")
        self.click(PICTURE_MIDDLE)
        self.key("ctrl+s")
        self.wait_for(self.scene.exists)
        first = self.scene.read_text()
        self.assertEqual(first.count("model:"), 1, first)
        self.assertIn("frame: ", first)
        self.screen("placed")
        x, y = PICTURE_MIDDLE
        self.drag((x, y - 6), (x + 50, y + 20))
        self.key("ctrl+s")
        self.wait_for(lambda: self.scene.read_text() != first)
        self.assertEqual(self.scene.read_text().count("model:"), 1)
        self.screen("dragged")
        # What was saved is a scene that can be rendered.
        planecast("render", TABLETOP, "--reconstruction", WORK / "map", "--scene", self.scene, "-o",
                  WORK / "rendered", "--frames", "0:5", "--quiet")

    def test_the_map_turns_and_frames_step(self):
        self.focus()
        before = self.pixels()
        self.drag(MAP_MIDDLE, (MAP_MIDDLE[0] + 80, MAP_MIDDLE[1] + 20))
        turned = self.pixels()
        self.assertNotEqual(turned, before)
        self.key("Right")
        self.assertNotEqual(self.pixels(), turned)

    def test_it_shows_what_the_screenshot_shows(self):
        self.xdotool("mousemove", 1270, 790)
        time.sleep(1.0)
        planecast("inspect", WORK / "map", "--sequence", TABLETOP, "--size",
                  f"{SIZE[0]}x{SIZE[1]}", "--screenshot", WORK / "shot.png", "--quiet")
        shot = subprocess.run(["ffmpeg", "-v", "error", "-i", str(WORK / "shot.png"), "-pix_fmt",
                               "rgb24", "-f", "rawvideo", "-"], check=True,
                              capture_output=True).stdout
        place = self.xdotool("getwindowgeometry", "--shell", self.window).stdout
        values = dict(line.split("=") for line in place.split())
        left, top = int(values["X"]), int(values["Y"])
        screen = self.pixels()
        for row in range(0, SIZE[1], 7):
            at = 3 * ((top + row) * 1280 + left)
            self.assertEqual(screen[at:at + 3 * SIZE[0]],
                             shot[3 * row * SIZE[0]:3 * (row + 1) * SIZE[0]], f"row {row}")

    def test_closing(self):
        self.focus()
        self.key("ctrl+q")
        self.assertEqual(self.inspector.wait(timeout=20), 0)


if __name__ == "__main__":
    unittest.main(argv=[sys.argv[0], *sys.argv[3:]])
