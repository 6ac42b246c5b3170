#!/usr/bin/env python3
"""`planecast model` on every sample file there is: each is drawn or refused in one line.

Usage: model_test.py PLANECAST WORK_FOLDER [unittest arguments]
"""

import os
import pathlib
import subprocess
import sys
import unittest

from cli import PLANECAST, ROOT, WORK, empty_work_folder, planecast

DATA = pathlib.Path(os.environ.get("PLANECAST_DATA", ROOT / ".." / "shared" / "data")) / "gltf"
VARIANTS = ROOT / "test/golden/models/variants.gltf"
PICTURE = WORK / "picture.png"
REFUSED = 2


def files_of(kind):
    return sorted(p for p in (DATA / kind).rglob("*") if p.suffix in (".gltf", ".glb"))


def draw(path):
    """Exit status and the lines of standard error beside the facts about the model."""
    PICTURE.unlink(missing_ok=True)
    done = subprocess.run(
        [str(PLANECAST), "model", str(path), "-o", str(PICTURE), "--views", "1", "--view-size", "64"],
        cwd=ROOT, capture_output=True, text=True, timeout=120)
    facts = ("size ", "animation ")
    return done.returncode, [l for l in done.stderr.splitlines() if not l.startswith(facts)]


def setUpModule():
    empty_work_folder()


@unittest.skipUnless(DATA.is_dir(), "no sample models on this machine")
class Samples(unittest.TestCase):
    def test_the_core_draws_without_a_warning(self):
        files = files_of("core")
        self.assertGreaterEqual(len(files), 37)
        for path in files:
            with self.subTest(path.name):
                status, lines = draw(path)
                self.assertEqual((status, lines), (0, []))
                self.assertTrue(PICTURE.is_file())

    def test_extensions_and_broken_files_draw_or_are_refused_in_one_line(self):
        refused = 0
        for path in files_of("extensions") + files_of("malformed"):
            with self.subTest(path.name):
                status, lines = draw(path)
                if status == REFUSED:
                    refused += 1
                    self.assertEqual(len(lines), 1, lines)
                    self.assertIn(path.name, lines[0])
                    self.assertFalse(PICTURE.exists())
                    continue
                self.assertEqual(status, 0, lines)
                self.assertTrue(all(l.startswith("warning: ") for l in lines), lines)
                self.assertTrue(PICTURE.is_file())
        self.assertGreater(refused, 5)


class Options(unittest.TestCase):
    def picture(self, *arguments):
        planecast("model", *arguments, "-o", PICTURE, "--views", 1, "--view-size", 96, "--quiet")
        return PICTURE.read_bytes()

    def test_animations_are_chosen_by_name_or_number(self):
        robot = ROOT / "assets/models/robot.glb"
        listed = planecast("model", robot, "--list").stdout.splitlines()
        names = [l.split("'")[1] for l in listed if l.startswith("animation ")]
        self.assertGreaterEqual(len(names), 2, listed)
        rest = self.picture(robot)
        second = self.picture(robot, "--animation", names[1], "--time", 0.4)
        self.assertNotEqual(rest, second)
        self.assertEqual(second, self.picture(robot, "--animation", 1, "--time", 0.4))
        self.assertNotEqual(second, self.picture(robot, "--animation", 1, "--time", 0.6))
        first = self.picture(robot, "--animation", 0, "--time", 0.4)
        self.assertEqual(first, self.picture(robot, "--time", 0.4))
        self.assertEqual(self.picture(robot, "--animation", 0), self.picture(robot, "--time", 0))
        without = planecast("model", VARIANTS, "-o", PICTURE, "--time", 1, expect=REFUSED)
        self.assertIn("no animation", without.stderr)
        wrong = planecast("model", robot, "-o", PICTURE, "--animation", "Swim", expect=REFUSED)
        self.assertIn("no animation 'Swim'", wrong.stderr)

    def test_variants_are_listed_and_drawn(self):
        listed = planecast("model", VARIANTS, "--list").stdout
        names = [l.split("'")[1] for l in listed.splitlines() if l.startswith("variant ")]
        self.assertGreaterEqual(len(names), 2, listed)
        pictures = {self.picture(VARIANTS, "--variant", name) for name in names}
        self.assertEqual(len(pictures), len(names))

    def test_a_camera_that_is_not_there_is_refused(self):
        wrong = planecast("model", VARIANTS, "-o", PICTURE, "--camera", 7, expect=REFUSED)
        self.assertIn("no camera 7", wrong.stderr)


if __name__ == "__main__":
    unittest.main(argv=[sys.argv[0], *sys.argv[3:]])
