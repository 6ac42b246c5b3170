#!/usr/bin/env python3
"""planecast inspect without a display: its screenshot, and its errors.

Usage: inspect_test.py PLANECAST WORK_FOLDER [unittest arguments]
"""

import os
import struct
import subprocess
import sys
import unittest

from cli import PLANECAST, ROOT, WORK, empty_work_folder, planecast

TABLETOP = WORK / "tabletop"


def setUpModule():
    empty_work_folder()
    planecast("synth", "tabletop", "-o", TABLETOP, "--width", 320, "--height", 240, "--count", 20,
              "--quiet")
    planecast("track", TABLETOP, "-o", WORK / "map", "--mode", "rgbd", "--quiet")
    (WORK / "scene.yaml").write_text(
        f"objects:\n  - model: {ROOT}/assets/models/block.glb\n"
        "    place: {plane: largest-horizontal}\n    size: 0.2\n", encoding="utf-8")


class Screenshot(unittest.TestCase):
    def shot(self, name, *arguments):
        planecast("inspect", WORK / "map", "--screenshot", WORK / name, "--quiet", *arguments)
        return (WORK / name).read_bytes()

    def test_same_bytes_twice_and_another_frame_is_another_picture(self):
        arguments = ("--sequence", TABLETOP, "--scene", WORK / "scene.yaml", "--size", "900x600")
        first = self.shot("a.png", *arguments, "--frame", 3)
        self.assertEqual(struct.unpack(">II", first[16:24]), (900, 600))
        self.assertEqual(self.shot("b.png", *arguments, "--frame", 3), first)
        self.assertNotEqual(self.shot("c.png", *arguments, "--frame", 15), first)

    def test_without_the_sequence_the_map_alone(self):
        self.assertGreater(len(self.shot("map.png")), 5000)


class Errors(unittest.TestCase):
    def refuse(self, *arguments, naming, environment=None):
        done = subprocess.run([str(PLANECAST), "inspect", *map(str, arguments)], cwd=ROOT,
                              capture_output=True, text=True, timeout=60,
                              env={**os.environ, **(environment or {})})
        self.assertEqual(done.returncode, 2, done.stderr)
        lines = done.stderr.strip().splitlines()
        self.assertEqual(len(lines), 1, done.stderr)
        self.assertIn(naming, lines[0])

    def test_no_reconstruction(self):
        self.refuse(WORK / "nowhere", "--screenshot", WORK / "x.png", naming="nowhere")

    def test_no_scene(self):
        self.refuse(WORK / "map", "--scene", WORK / "lost.yaml", "--screenshot", WORK / "x.png",
                    naming="lost.yaml")

    def test_no_display(self):
        self.refuse(WORK / "map", naming="window",
                    environment={"DISPLAY": "", "WAYLAND_DISPLAY": ""})


if __name__ == "__main__":
    unittest.main(argv=[sys.argv[0], *sys.argv[3:]])
