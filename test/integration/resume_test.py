#!/usr/bin/env python3
"""kill -9 at seeded random moments of tracking and rendering; the resumed run ends with the same bytes as
one that was never killed.

Usage: resume_test.py PLANECAST WORK_FOLDER [--kills N] [unittest arguments]
"""

import random
import shutil
import sys
import unittest

from cli import ROOT, WORK, empty_work_folder, planecast
from stopping import differing, kill

KILLS = int(sys.argv.pop(sys.argv.index("--kills") + 1)) if "--kills" in sys.argv else 2
if "--kills" in sys.argv:
    sys.argv.remove("--kills")
SEQUENCE = WORK / "tabletop"
FRAMES = 200
WHOLE = WORK / "whole"
SCENE = WORK / "scene.yaml"
RUN = ("run", SEQUENCE, "--scene", SCENE, "--png")


def setUpModule():
    empty_work_folder()
    planecast("synth", "tabletop", "-o", SEQUENCE, "--width", 160, "--height", 120, "--count", FRAMES,
              "--quiet")
    SCENE.write_text(f"occlusion: both\nobjects:\n  - model: {ROOT}/assets/models/robot.glb\n"
                     "    place: {plane: largest-horizontal, at: [0.5, 0.5]}\n    size: 0.3\n"
                     "    animation: Wave\n", encoding="utf-8")
    planecast(*RUN, "-o", WHOLE, "--quiet")


def moments():
    """Half of them in tracking (its two passes), half in rendering."""
    generator = random.Random("resume")
    for i in range(KILLS):
        work, frames = (("tracking", 2 * FRAMES), ("rendering", FRAMES))[i % 2]
        yield work, frames, generator.randrange(1, frames - 10)


class Resume(unittest.TestCase):
    def test_same_bytes_after_a_kill(self):
        killed = {"tracking": 0, "rendering": 0}
        for i, (work, total, frame) in enumerate(moments()):
            with self.subTest(work=work, frame=frame):
                out = WORK / f"killed_{i}"
                # The bar shows some frames, not all.
                later = "|".join(str(number) for number in range(frame, frame + 45))
                if kill(rf"{work} +\[[#.]+\] ({later})/{total} ", *RUN, "-o", out):
                    killed[work] += 1
                self.assertFalse((out / "augmented.mp4").exists())
                planecast(*RUN, "-o", out, "--resume", "--quiet")
                self.assertEqual(differing(out, WHOLE), [])
                self.assertFalse((out / "segments").exists())
        print(f"killed in tracking {killed['tracking']}, in rendering {killed['rendering']} times")
        self.assertEqual(killed["tracking"], (KILLS + 1) // 2)
        self.assertEqual(killed["rendering"], KILLS // 2)

    def test_complete_segments_are_kept(self):
        out = WORK / "segments"
        self.assertTrue(kill(rf"rendering +\[[#.]+\] 1[3-9]\d/{FRAMES} ", *RUN, "-o", out))
        first = out / "segments" / "000000.mp4"
        before = first.stat().st_mtime_ns
        self.assertTrue((out / "segments" / "000001.mp4").exists())
        self.assertTrue(kill(rf"rendering +\[[#.]+\] 1[5-9]\d/{FRAMES} ", *RUN, "-o", out, "--resume"))
        self.assertEqual(first.stat().st_mtime_ns, before)

    def test_what_was_made_otherwise_is_made_anew(self):
        out = WORK / "otherwise"
        self.assertTrue(kill(rf"rendering +\[[#.]+\] \d+/{FRAMES} ", *RUN, "-o", out))
        mono = WORK / "mono"
        planecast(*RUN, "--mode", "mono", "-o", mono, "--quiet")
        planecast(*RUN, "--mode", "mono", "-o", out, "--resume", "--quiet")
        self.assertEqual(differing(out, mono), [])
        shutil.rmtree(mono)

    def test_the_report_of_a_resumed_run_has_the_times_of_tracking(self):
        out = WORK / "times"
        self.assertTrue(kill(rf"rendering +\[[#.]+\] \d+/{FRAMES} ", *RUN, "-o", out))
        planecast(*RUN, "-o", out, "--resume", "--quiet")
        whole = (WHOLE / "report.html").read_text(encoding="utf-8")
        report = (out / "report.html").read_text(encoding="utf-8")
        for row in ("Local BA", "New Plane Detection", "Tracking"):
            self.assertEqual(report.count(row), whole.count(row), row)


if __name__ == "__main__":
    unittest.main(argv=[sys.argv[0], *sys.argv[3:]])
