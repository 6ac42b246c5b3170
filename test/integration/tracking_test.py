#!/usr/bin/env python3
"""Tracking over whole sequences: the same bytes at any number of threads, real data among them
where it is present, and the memory of a long walk.

Usage: tracking_test.py PLANECAST WORK_FOLDER [unittest arguments]
"""

import os
import pathlib
import subprocess
import sys
import unittest

from cli import PLANECAST, ROOT, WORK, empty_work_folder, planecast

FILES = ("trajectory.txt", "trajectory_causal.txt", "keyframes.txt", "frames.csv", "planes.json",
         "map.ply", "map.bin")
DATA = pathlib.Path(os.environ.get("PLANECAST_DATA", ROOT / "../shared/data")) / "sequences"
MAX_MEMORY_MB = 400


def setUpModule():
    empty_work_folder()


class SameBytes(unittest.TestCase):
    def check(self, sequence, mode, *arguments):
        for threads in (1, 2):
            planecast("track", sequence, "-o", WORK / f"t{threads}", "--mode", mode, "--threads",
                      threads, "--quiet", *arguments)
        for file in FILES:
            self.assertEqual((WORK / "t1" / file).read_bytes(), (WORK / "t2" / file).read_bytes(),
                             file)

    def test_built_in_scenes(self):
        # The ring closes a loop, the other loses its way.
        for scene, fps in (("ring", 15), ("tracking-loss", 30)):
            folder = WORK / scene
            planecast("synth", scene, "-o", folder, "--width", 320, "--height", 240, "--fps", fps,
                      "--quiet")
            for mode in ("mono", "rgbd"):
                with self.subTest(scene=scene, mode=mode):
                    self.check(folder, mode)

    def test_real_data(self):
        for name, camera, modes in (("tum_fr3_office_a", "tum-fr3", ("mono",)),
                                    ("redkitchen_a", "7scenes", ("mono", "rgbd"))):
            for mode in modes:
                with self.subTest(sequence=name, mode=mode):
                    if not (DATA / name).is_dir():
                        self.skipTest(f"{DATA / name} is not there")
                    self.check(DATA / name, mode, "--camera", camera)


class Memory(unittest.TestCase):
    def test_three_thousand_frames_of_one_room(self):
        folder = WORK / "revisit"
        planecast("synth", "revisit", "-o", folder, "--width", 480, "--height", 360, "--count", 3000,
                  "--quiet")
        child = subprocess.Popen(
            [str(PLANECAST), "track", str(folder), "-o", str(WORK / "walk"), "--mode", "rgbd",
             "--quiet"], cwd=ROOT)
        _, status, usage = os.wait4(child.pid, 0)
        self.assertEqual(os.waitstatus_to_exitcode(status), 0)
        # Kilobytes.
        self.assertLess(usage.ru_maxrss / 1024, MAX_MEMORY_MB)


if __name__ == "__main__":
    unittest.main(argv=[sys.argv[0], *sys.argv[3:]])
