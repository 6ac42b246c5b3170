#!/usr/bin/env python3
"""SIGINT and SIGTERM: one line, 130 or 143, what was done is there, and a resumed run ends with the same
bytes as one that was never interrupted.

Usage: cancel_test.py PLANECAST WORK_FOLDER [unittest arguments]
"""

import json
import re
import shutil
import signal
import sys
import unittest

from cli import WORK, empty_work_folder, planecast
from stopping import differing, read_until, start, stop

SEQUENCE = WORK / "tabletop"
FRAMES = 150
WHOLE = WORK / "whole"
RUN = ("run", SEQUENCE, "--mode", "rgbd", "--segmentation", "masks")


def setUpModule():
    empty_work_folder()
    planecast("synth", "tabletop", "-o", SEQUENCE, "--width", 320, "--height", 240, "--count", FRAMES,
              "--quiet")
    planecast(*RUN, "-o", WHOLE, "--quiet")


def frame(number, total, work):
    """The bar of this work at this frame or not many later: on a fast machine few frames are drawn."""
    shown = "|".join(str(later) for later in range(number, number + 65))
    return rf"{work} +\[[#.]+\] ({shown})/{total} "


class Interrupted(unittest.TestCase):
    def interrupt(self, moment, by, *arguments):
        status, line, came = stop(moment, by, *arguments)
        self.assertTrue(came, f"{moment} was not seen before the end: {line}")
        self.assertEqual(status, 128 + by, line)
        self.assertTrue(line.startswith(f"planecast: interrupted by {by.name}: "), line)
        return line

    def resumed(self, out):
        planecast(*RUN, "-o", out, "--resume", "--quiet")
        self.assertEqual(differing(out, WHOLE), [])

    def test_in_the_first_pass(self):
        for number, by in ((1, signal.SIGTERM), (80, signal.SIGINT)):
            with self.subTest(frame=number):
                out = WORK / f"first_pass_{number}"
                line = self.interrupt(frame(number, 2 * FRAMES, "tracking"), by, *RUN, "-o", out,
                                      "--json", WORK / "figures.json")
                self.assertRegex(line, r"\d+ frames were tracked")
                frames = (out / "frames.csv").read_text(encoding="utf-8").splitlines()[1:]
                self.assertGreaterEqual(len(frames), number)
                self.assertLess(len(frames), FRAMES)
                poses = (out / "trajectory.txt").read_text(encoding="utf-8").splitlines()
                self.assertGreaterEqual(len(poses), number - 2)
                summary = json.loads((out / "summary.json").read_text(encoding="utf-8"))
                self.assertEqual(summary["stopped"], "interrupted")
                figures = json.loads((WORK / "figures.json").read_text(encoding="utf-8"))
                self.assertTrue(figures["interrupted"])
                # Readable: what there is of it can be drawn.
                planecast("render", SEQUENCE, "--reconstruction", out, "-o", out / "drawn", "--quiet",
                          "--frames", "0:3")
                shutil.rmtree(out / "drawn")
                self.resumed(out)

    def test_in_the_second_pass(self):
        out = WORK / "second_pass"
        self.interrupt(frame(FRAMES + 60, 2 * FRAMES, "tracking"), signal.SIGINT, *RUN, "-o", out)
        frames = (out / "frames.csv").read_text(encoding="utf-8").splitlines()[1:]
        self.assertEqual(len(frames), FRAMES)
        self.resumed(out)

    def test_in_rendering(self):
        for number, by in ((20, signal.SIGINT), (100, signal.SIGTERM)):
            with self.subTest(frame=number):
                out = WORK / f"rendering_{number}"
                line = self.interrupt(frame(number, FRAMES, "rendering"), by, *RUN, "-o", out)
                self.assertRegex(line, r"\d+ frames were drawn; .*segments.*--resume")
                drawn = int(re.search(r"(\d+) frames were drawn", line)[1])
                self.assertGreaterEqual(drawn, number)
                self.assertLess(drawn, FRAMES)
                segments = sorted(path.name for path in (out / "segments").glob("*"))
                complete = [f"{i:06}.mp4" for i in range(drawn // 60)]
                self.assertEqual(segments, complete + ["settings.txt"])
                self.assertFalse((out / "augmented.mp4").exists())
                self.resumed(out)

    def test_tracking_alone(self):
        out = WORK / "track"
        self.interrupt(frame(60, 2 * FRAMES, "tracking"), signal.SIGTERM, "track", *RUN[1:], "-o", out)
        self.assertTrue((out / "map.bin").exists())

    def test_masks(self):
        out = WORK / "masks"
        self.interrupt(frame(30, FRAMES, "segmenting"), signal.SIGINT, "segment", SEQUENCE,
                       "--segmentation", "depth", "-o", out)
        lines = (out / "mask.txt").read_text(encoding="utf-8").splitlines()
        names = [line.split()[1] for line in lines if not line.startswith("#")]
        self.assertGreaterEqual(len(names), 30)
        for name in names:
            self.assertTrue((out / name).is_file(), name)

    def test_a_made_sequence_has_no_lists(self):
        out = WORK / "made"
        self.interrupt(frame(10, 300, "making"), signal.SIGINT, "synth", "tabletop", "-o", out, "--width",
                       160, "--height", 120, "--count", 300)
        self.assertFalse((out / "rgb.txt").exists())

    def test_a_benchmark_ends_its_run_and_keeps_those_before(self):
        config = WORK / "config.yaml"
        config.write_text(f"sequences:\n  - {{name: table, path: {SEQUENCE}, modes: [rgbd]}}\nseeds: [1, 2]\n",
                          encoding="utf-8")
        line = self.interrupt(r"\[1/2\]", signal.SIGTERM, "benchmark", config, "-o", WORK / "bench")
        self.assertIn("--resume", line)
        rows = (WORK / "bench" / "results.csv").read_text(encoding="utf-8").splitlines()
        self.assertEqual(len(rows), 2, rows)


class Twice(unittest.TestCase):
    def test_the_second_signal_ends_it_at_once(self):
        process, terminal = start(*RUN, "-o", WORK / "twice")
        read_until(terminal, "tracking")
        process.send_signal(signal.SIGTERM)
        process.send_signal(signal.SIGINT)
        self.assertIn(process.wait(timeout=60), (128 + signal.SIGTERM, 128 + signal.SIGINT))
        process.stdout.close()


if __name__ == "__main__":
    unittest.main(argv=[sys.argv[0], *sys.argv[3:]])
