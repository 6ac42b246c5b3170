#!/usr/bin/env python3
"""Runs `planecast benchmark` on a tiny suite: a run that works, one that fails, a sequence that is absent.

Usage: benchmark_test.py PLANECAST WORK_FOLDER [unittest arguments]
"""

import csv
import sys
import unittest

from cli import WORK, empty_work_folder, planecast

CONFIG = """
title: Tiny suite
modes: [rgbd]
curves: [{x: frames, y: seconds}]
variants:
  - name: default
  - {name: broken, options: [--plane-fit, nonsense]}
sequences:
  - {name: table, synth: {scene: tabletop, frames: 24, width: 160, height: 120}}
  - {name: absent, path: nowhere, variants: [default]}
"""


class Benchmark(unittest.TestCase):
    @classmethod
    def setUpClass(cls):
        empty_work_folder()
        (WORK / "config.yaml").write_text(CONFIG, encoding="utf-8")
        planecast("benchmark", WORK / "config.yaml", "-o", WORK / "out", expect=1)
        with open(WORK / "out" / "results.csv", encoding="utf-8") as lines:
            cls.rows = {(row["sequence"], row["variant"]): row for row in csv.DictReader(lines)}

    def test_a_failing_run_is_a_row_and_not_the_end(self):
        self.assertEqual(len(self.rows), 3)
        self.assertEqual(self.rows["table", "default"]["status"], "ok")
        self.assertIn("failed: ", self.rows["table", "broken"]["status"])
        self.assertIn("nonsense", self.rows["table", "broken"]["status"])
        self.assertEqual(self.rows["absent", "default"]["status"], "not present")

    def test_the_figures_are_those_of_evaluate(self):
        row = self.rows["table", "default"]
        sequence = next(path for path in (WORK / "out" / "sequences").iterdir() if path.is_dir())
        run = WORK / "out" / "runs" / "table_rgbd_default_1"
        table = planecast("evaluate", "planes", "--reconstruction", run, "--groundtruth", sequence)
        self.assertIn(f"{float(row['precision_5']):.3f}", table.stdout.splitlines()[1])
        self.assertEqual(float(row["frames"]), 24)
        self.assertGreater(float(row["peak_mb"]), 20)
        self.assertGreater(float(row["cpu_seconds"]), 0)
        # 160 pixels wide and 2 m away, a pixel is 1.5 cm.
        self.assertLess(float(row["ate_cm"]), 1.5)

    def test_results_and_plots_are_written(self):
        text = (WORK / "out" / "results.md").read_text(encoding="utf-8")
        self.assertIn("Not present, so not run: absent", text)
        self.assertIn("![ATE by sequence](plots/ate.svg)", text)
        for name in ("ate", "trajectories", "seconds-over-frames"):
            self.assertIn("<svg", (WORK / "out" / "plots" / f"{name}.svg").read_text())

    def test_resume_keeps_what_is_complete(self):
        run = WORK / "out" / "runs" / "table_rgbd_default_1" / "run.json"
        before = run.stat().st_mtime_ns
        # The broken variant is tried again.
        planecast("benchmark", WORK / "config.yaml", "-o", WORK / "out", "--resume", "--only", "table",
                  expect=1)
        self.assertEqual(run.stat().st_mtime_ns, before)

    def test_bad_use_is_one_line(self):
        for arguments, words in (
            (("benchmark", WORK / "none.yaml", "-o", WORK / "x"), "none.yaml"),
            (("benchmark", WORK / "config.yaml", "-o", WORK / "x", "--only", "moon"), "moon"),
        ):
            done = planecast(*arguments, expect=2)
            self.assertEqual(len(done.stderr.strip().splitlines()), 1, done.stderr)
            self.assertIn(words, done.stderr)


if __name__ == "__main__":
    unittest.main(argv=[sys.argv[0], *sys.argv[3:]])
