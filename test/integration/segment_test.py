#!/usr/bin/env python3
"""Plane masks as a user makes and uses them: a sequence, one image, other people's networks, bad ones.

Usage: segment_test.py PLANECAST WORK_FOLDER [unittest arguments]
"""

import json
import shutil
import sys
import unittest

from cli import ROOT, WORK, empty_work_folder, planecast

TABLETOP = WORK / "tabletop"
FRAMES = 40
INSTANCES = ROOT / "test/unit/engine/networks/instances.onnx"


def setUpModule():
    empty_work_folder()
    planecast("synth", "tabletop", "-o", TABLETOP, "--width", 320, "--height", 240,
              "--count", FRAMES, "--quiet")


def segmentation_of(folder):
    return json.loads((folder / "summary.json").read_text(encoding="utf-8"))["segmentation"]


class Masks(unittest.TestCase):
    def test_sequence_with_overlays(self):
        out = WORK / "network"
        done = planecast("segment", TABLETOP, "--segmentation", "network", "--overlay", "--frames",
                         "0:4", "-o", out, "--no-progress")
        self.assertIn("plane masks: network planes 3 ", done.stderr)
        masks = (out / "mask.txt").read_text(encoding="utf-8").splitlines()
        self.assertEqual(len([line for line in masks if not line.startswith("#")]), 4)
        self.assertEqual(len(list((out / "mask").glob("*.png"))), 4)
        self.assertEqual(len(list((out / "overlay").glob("*.png"))), 4)
        figures = WORK / "masks.json"
        planecast("evaluate", "masks", "--estimate", out, "--groundtruth", TABLETOP, "--json", figures)
        self.assertEqual(json.loads(figures.read_text(encoding="utf-8"))["frames"], FRAMES)

    def test_one_image(self):
        image = sorted((TABLETOP / "rgb").iterdir())[0]
        out = WORK / "image"
        planecast("segment", image, "-o", out, "--overlay", "--quiet")
        self.assertTrue((out / "overlay" / "000000.png").exists())
        # The same as that frame of the sequence.
        again = WORK / "first"
        planecast("segment", TABLETOP, "--segmentation", "network", "--frames", "0:1", "-o", again,
                  "--quiet")
        self.assertEqual((out / "mask/000000.png").read_bytes(),
                         (again / "mask/000000.png").read_bytes())

    def test_somebody_elses_network(self):
        out = WORK / "instances"
        planecast("segment", TABLETOP, "--network", INSTANCES, "--frames", "0:2", "-o", out,
                  "--quiet")
        self.assertIn("by network red-green-blue 3 ", (out / "mask.txt").read_text(encoding="utf-8"))


class Choice(unittest.TestCase):
    def test_tracking_records_what_gave_the_masks(self):
        kinds = {
            "auto": ("masks 1", []),
            "network": ("network planes 3 ", []),
            "none": ("none", []),
            "depth": ("depth ", ["--mode", "rgbd"]),
        }
        for kind, (name, more) in kinds.items():
            out = WORK / f"track_{kind}"
            done = planecast("track", TABLETOP, "-o", out, "--segmentation", kind, "--no-progress",
                             "--causal", *(more or ["--mode", "mono"]))
            self.assertTrue(segmentation_of(out).startswith(name), segmentation_of(out))
            self.assertIn(f"plane masks: {segmentation_of(out)}", done.stderr)

    def test_network_gives_the_same_bytes_on_one_thread_and_two(self):
        for threads in (1, 2):
            planecast("track", TABLETOP, "-o", WORK / f"threads{threads}", "--mode", "mono",
                      "--segmentation", "network", "--threads", threads, "--quiet")
        for file in ("trajectory.txt", "planes.json", "map.bin"):
            self.assertEqual((WORK / "threads1" / file).read_bytes(),
                             (WORK / "threads2" / file).read_bytes(), file)


class BadNetworks(unittest.TestCase):
    def refuse(self, *arguments, naming):
        done = planecast("segment", *arguments, "-o", WORK / "bad", "--quiet", expect=2)
        lines = done.stderr.strip().splitlines()
        self.assertEqual(len(lines), 1, done.stderr)
        for word in naming:
            self.assertIn(word, lines[0])

    def test_missing_broken_or_undescribed(self):
        self.refuse(TABLETOP, "--network", "no/such.onnx", naming=["no/such.onnx", "cannot be read"])
        bare = WORK / "bare.onnx"
        shutil.copy(INSTANCES, bare)
        self.refuse(TABLETOP, "--network", bare, naming=["bare.yaml"])
        shutil.copy(INSTANCES.with_suffix(".yaml"), WORK / "bare.yaml")
        bare.write_bytes(INSTANCES.read_bytes()[:200])
        self.refuse(TABLETOP, "--network", bare, naming=["bare.onnx"])

    def test_choices_that_do_not_go_together(self):
        self.refuse(TABLETOP, "--network", INSTANCES, "--segmentation", "none", naming=["--network"])
        image = sorted((TABLETOP / "rgb").iterdir())[0]
        self.refuse(image, "--segmentation", "depth", naming=[image.name, "depth"])
        images = WORK / "images"
        images.mkdir()
        shutil.copy(image, images)
        self.refuse(images, "--segmentation", "masks", naming=["images", "mask.txt"])


if __name__ == "__main__":
    unittest.main(argv=[sys.argv[0], *sys.argv[3:]])
