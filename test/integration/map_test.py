#!/usr/bin/env python3
"""Localises the second half of a walk in the map of its first half, and refuses broken maps.

Usage: map_test.py PLANECAST WORK_FOLDER [unittest arguments]
"""

import json
import sys
import unittest

from cli import WORK, empty_work_folder, planecast

SCENE = WORK / "room"
FIRST = WORK / "first"
# Around the room at 10 frames a second: 300 frames, of which the first half is mapped.
FRAMES = 300
HALF = FRAMES // 2
# The sequence is 320 x 240 and its room about 3 m deep: 2 cm is 2 px there.
MAX_ATE_M = 0.02


def setUpModule():
    empty_work_folder()
    planecast("synth", "room", "-o", SCENE, "--width", 320, "--height", 240, "--fps", 10,
              "--quiet")
    planecast("track", SCENE, "-o", FIRST, "--frames", f"0:{HALF}", "--quiet")


def world_positions(trajectory):
    lines = trajectory.read_text(encoding="utf-8").splitlines()
    rows = [line.split() for line in lines if line and not line.startswith("#")]
    return {round(float(row[0]), 4): [float(v) for v in row[1:4]] for row in rows}


class SecondSequence(unittest.TestCase):
    def test_is_localised_in_the_map_of_the_first(self):
        out = WORK / "second"
        planecast("track", SCENE, "--frames", f"{HALF}:{FRAMES}", "--map", FIRST, "-o", out,
                  "--quiet")
        posed = world_positions(out / "trajectory.txt")
        self.assertGreaterEqual(len(posed), 0.95 * (FRAMES - HALF))
        # One world: both halves together fit the truth.
        both = WORK / "both.txt"
        both.write_text((FIRST / "trajectory.txt").read_text(encoding="utf-8")
                        + (out / "trajectory.txt").read_text(encoding="utf-8"), encoding="utf-8")
        figures = WORK / "ate.json"
        planecast("evaluate", "trajectory", "--estimate", both, "--groundtruth",
                  SCENE / "groundtruth.txt", "--align", "se3", "--json", figures)
        self.assertLess(json.loads(figures.read_text(encoding="utf-8"))["ate_m"]["rmse"], MAX_ATE_M)

    def test_threads_change_no_byte(self):
        for threads in (1, 2):
            planecast("track", SCENE, "--frames", f"{HALF}:{HALF + 40}", "--map", FIRST, "-o",
                      WORK / f"t{threads}", "--threads", threads, "--quiet")
        for name in ("trajectory.txt", "trajectory_causal.txt", "keyframes.txt", "frames.csv",
                     "planes.json", "map.ply", "map.bin"):
            self.assertEqual((WORK / "t1" / name).read_bytes(), (WORK / "t2" / name).read_bytes(),
                             name)

    def test_a_map_that_cannot_be_used_is_refused_in_one_line(self):
        bytes_of_map = (FIRST / "map.bin").read_bytes()
        bad = WORK / "bad"
        bad.mkdir(exist_ok=True)
        for content in (b"", b"PLNCMAP\0\1\0\0\0", bytes_of_map[:-5], bytes_of_map[:1000],
                        bytes_of_map[:5000] + b"\1" + bytes_of_map[5001:]):
            (bad / "map.bin").write_bytes(content)
            done = planecast("track", SCENE, "--map", bad, "-o", WORK / "never", "--quiet",
                             expect=2)
            self.assertEqual(len(done.stderr.strip().splitlines()), 1, done.stderr)
            self.assertIn("map.bin", done.stderr)
        done = planecast("track", SCENE, "--map", WORK / "none", "-o", WORK / "never", expect=2)
        self.assertIn("none", done.stderr)
        done = planecast("track", SCENE, "--size", "640x480", "--map", FIRST, "-o",
                         WORK / "never", expect=2)
        self.assertIn("another camera", done.stderr)


if __name__ == "__main__":
    unittest.main(argv=[sys.argv[0], *sys.argv[3:]])
