#!/usr/bin/env python3
"""`planecast golden` as a team would use it: begin, take pictures, check them, see a difference.

Usage: golden_test.py PLANECAST WORK_FOLDER [unittest arguments]
"""

import json
import pathlib
import re
import shutil
import sys
import unittest
import xml.etree.ElementTree

from cli import ROOT, WORK, empty_work_folder, planecast

SUITE = WORK / "suite"
EXAMPLE = ROOT / "test" / "golden" / "example"
CASE = """
cases:
  - name: block
    synth: {scene: tabletop, width: 160, height: 120, frames: 16, effects: false}
    scene: scene.yaml
    mode: rgbd
    frames: [4, 12]
"""


def write_scene(size):
    (SUITE / "scene.yaml").write_text(
        f"objects:\n  - model: {ROOT}/assets/models/block.glb\n    size: {size}\n"
        "    place: {plane: largest-horizontal, at: [0.5, 0.5]}\n", encoding="utf-8")


def check(*arguments, expect=0):
    return planecast("golden", "check", SUITE, "--no-progress", *arguments, expect=expect)


def restore(folder):
    shutil.rmtree(SUITE / "expected")
    shutil.copytree(folder, SUITE / "expected")


def setUpModule():
    empty_work_folder()
    SUITE.mkdir()
    (SUITE / "golden.yaml").write_text(CASE, encoding="utf-8")
    write_scene(0.2)
    planecast("golden", "update", SUITE, "--no-progress")
    shutil.copytree(SUITE / "expected", WORK / "kept")


class Check(unittest.TestCase):
    def setUp(self):
        restore(WORK / "kept")
        write_scene(0.2)

    def test_the_same_pictures_pass(self):
        done = check("--junit", WORK / "same.xml", "--json", WORK / "same.json")
        self.assertIn("2 of 2 pictures as expected", done.stderr)
        suites = xml.etree.ElementTree.parse(WORK / "same.xml").getroot()
        self.assertEqual((suites.get("tests"), suites.get("failures"), suites.get("errors")),
                         ("2", "0", "0"))
        figures = json.loads((WORK / "same.json").read_text(encoding="utf-8"))
        # Drawn again by the same program: not one bit differs.
        self.assertEqual([picture["max_difference"] for picture in figures["pictures"]], [0, 0])

    def test_a_larger_object_is_a_difference(self):
        write_scene(0.3)
        done = check("--junit", WORK / "larger.xml", expect=1)
        lines = [line for line in done.stderr.splitlines() if line.startswith("planecast: block/")]
        self.assertEqual(len(lines), 2, done.stderr)
        self.assertRegex(lines[0], r"block/000004: largest difference \d+ of 255, .* SSIM")
        case = xml.etree.ElementTree.parse(WORK / "larger.xml").getroot().find("testsuite/testcase")
        self.assertEqual((case.get("classname"), case.get("name")), ("block", "frame 4"))
        self.assertIn("largest difference", case.find("failure").get("message"))
        report = pathlib.Path(done.stdout.strip()).read_text(encoding="utf-8")
        data = json.loads(re.search(r'<script type="application/json" id="data">(.*?)</script>',
                                    report, re.DOTALL).group(1))
        for key in ("expected", "actual", "difference"):
            self.assertTrue(data[0][key].startswith("data:image/png;base64,"), key)
        self.assertNotRegex(report, r'(src|href)="http')

    def test_a_missing_expected_picture(self):
        (SUITE / "expected" / "block" / "000012.png").unlink()
        done = check(expect=2)
        line, = [line for line in done.stderr.splitlines() if line.startswith("planecast: ")]
        self.assertIn("block/000012.png: missing", line)
        self.assertIn("1 of 2 pictures", done.stderr)

    def test_another_size_is_a_difference(self):
        text = CASE.replace("mode: rgbd", "mode: rgbd\n    size: 128x96")
        (SUITE / "golden.yaml").write_text(text, encoding="utf-8")
        try:
            done = check(expect=1)
        finally:
            (SUITE / "golden.yaml").write_text(CASE, encoding="utf-8")
        self.assertIn("000004.png is 160x120, the picture drawn 128x96", done.stderr)

    def test_a_damaged_expected_picture(self):
        (SUITE / "expected" / "block" / "000012.png").write_bytes(b"no picture")
        self.assertIn("000012.png", check(expect=2).stderr)

    def test_a_case_that_cannot_be_drawn_does_not_end_the_others(self):
        broken = CASE + CASE.split("cases:\n")[1].replace("block", "broken").replace(
            "frames: [4, 12]", "frames: [4, 99]")
        (SUITE / "golden.yaml").write_text(broken, encoding="utf-8")
        try:
            done = check("--junit", WORK / "broken.xml", expect=2)
            # An update with it changes nothing.
            before = {path.name: path.stat().st_mtime_ns
                      for path in (SUITE / "expected" / "block").iterdir()}
            planecast("golden", "update", SUITE, "--no-progress", expect=2)
            after = {path.name: path.stat().st_mtime_ns
                     for path in (SUITE / "expected" / "block").iterdir()}
        finally:
            (SUITE / "golden.yaml").write_text(CASE, encoding="utf-8")
        self.assertIn("2 of 3 pictures as expected", done.stderr)
        self.assertIn("no frame 99", done.stderr)
        suites = xml.etree.ElementTree.parse(WORK / "broken.xml").getroot()
        self.assertEqual(suites.get("errors"), "1")
        self.assertEqual(before, after)


class Update(unittest.TestCase):
    def test_takes_the_new_pictures_and_drops_the_old(self):
        restore(WORK / "kept")
        (SUITE / "expected" / "gone").mkdir()
        write_scene(0.3)
        planecast("golden", "update", SUITE, "--no-progress")
        check()
        names = sorted(str(path.relative_to(SUITE)) for path in SUITE.rglob("*.png")
                       if "out" not in path.relative_to(SUITE).parts)
        self.assertEqual(names, ["expected/block/000004.png", "expected/block/000012.png"])
        self.assertFalse((SUITE / "expected" / "gone").exists())
        self.assertEqual([path.name for path in SUITE.iterdir() if "part" in path.name], [])


class Init(unittest.TestCase):
    def test_begins_a_suite_that_works(self):
        folder = WORK / "new"
        planecast("golden", "init", folder)
        planecast("golden", "update", folder, "--no-progress")
        planecast("golden", "check", folder, "--no-progress")
        self.assertEqual((folder / ".gitignore").read_text(encoding="utf-8"), "out/\n")
        done = planecast("golden", "init", folder, expect=2)
        self.assertIn("is there already", done.stderr)


class Mistakes(unittest.TestCase):
    def test_are_one_line_with_the_place(self):
        folder = WORK / "mistakes"
        folder.mkdir()
        base = "cases:\n  - name: a\n    synth: tabletop\n    frames: [1]\n"
        for text, words in (
            (base + "    colour: red\n", ["golden.yaml:5", "unknown key 'colour'"]),
            (base + "    tolerance: {channel: 300}\n", ["golden.yaml:5", "channel"]),
            (base + "    tolerance: {chanel: 3}\n", ["golden.yaml:5", "unknown key 'chanel'"]),
            (base + "    scene: lost.yaml\n", ["golden.yaml:5", "lost.yaml"]),
            (base + "    camera: lost.yaml\n", ["golden.yaml:5", "lost.yaml"]),
            (base + "    sequence: .\n", ["golden.yaml", "either"]),
            (base.replace("tabletop", "moon"), ["golden.yaml:3", "moon"]),
            (base.replace("[1]", "[]"), ["golden.yaml:4", "frames"]),
            (base.replace("name: a", "name: a/b"), ["golden.yaml:2", "a/b"]),
            (base + base.split("cases:\n")[1], ["golden.yaml:5", "twice"]),
            ("cases: []\n", ["golden.yaml:1", "cases"]),
            ("cases: [\n", ["golden.yaml", "YAML"]),
        ):
            with self.subTest(text=text):
                (folder / "golden.yaml").write_text(text, encoding="utf-8")
                done = planecast("golden", "check", folder, expect=2)
                self.assertEqual(len(done.stderr.strip().splitlines()), 1, done.stderr)
                for word in words:
                    self.assertIn(word, done.stderr)

    def test_no_suite_and_no_case(self):
        done = planecast("golden", "check", WORK / "kept", expect=2)
        self.assertIn("golden init", done.stderr)
        done = planecast("golden", "check", SUITE, "--only", "moon", expect=2)
        self.assertIn("moon", done.stderr)


class Example(unittest.TestCase):
    def test_the_worked_example_holds(self):
        planecast("golden", "check", EXAMPLE, "-o", WORK / "example", "--no-progress")


if __name__ == "__main__":
    unittest.main(argv=[sys.argv[0], *sys.argv[3:]])
