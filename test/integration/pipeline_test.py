#!/usr/bin/env python3
"""Runs the planecast executable as a user would: every kind of input, and every kind of bad input.

Usage: pipeline_test.py PLANECAST WORK_FOLDER [unittest arguments]
"""

import json
import shutil
import subprocess
import sys
import unittest

from cli import ROOT, WORK, empty_work_folder, planecast

TABLETOP = WORK / "tabletop"
FRAMES = 60
INTRINSICS = TABLETOP / "camera.yaml"
# The sequence is 320 x 240 and its scene about 2 m deep: 1 cm is 1.3 px there.
MAX_ATE_M = 0.01


def make_scene(folder, **changes):
    place = changes.get("place", "{plane: largest-horizontal, at: [0.5, 0.5]}")
    text = (
        f"objects:\n  - model: {ROOT}/assets/models/block.glb\n    place: {place}\n    size: 0.1\n"
        + changes.get("extra", "")
    )
    path = folder / "scene.yaml"
    path.write_text(text, encoding="utf-8")
    return path


def frame_count(video):
    probe = subprocess.run(
        ["ffprobe", "-v", "error", "-count_frames", "-select_streams", "v:0", "-show_entries",
         "stream=nb_read_frames,codec_name", "-of", "json", str(video)],
        capture_output=True, text=True, check=True,
    )
    stream = json.loads(probe.stdout)["streams"][0]
    assert stream["codec_name"] == "h264", stream
    return int(stream["nb_read_frames"])


def setUpModule():
    empty_work_folder()
    planecast("synth", "tabletop", "-o", TABLETOP, "--width", 320, "--height", 240,
              "--count", FRAMES, "--quiet")
    images = WORK / "images"
    images.mkdir()
    for picture in sorted((TABLETOP / "rgb").iterdir()):
        shutil.copy(picture, images / picture.name)
    subprocess.run(
        ["ffmpeg", "-v", "error", "-framerate", "30", "-pattern_type", "glob", "-i",
         f"{images}/*.png", "-c:v", "libx264", "-crf", "12", "-pix_fmt", "yuv420p",
         str(WORK / "clip.mp4")],
        check=True,
    )


class EveryKindOfInput(unittest.TestCase):
    """The whole way: sequence in, video and reconstruction out, poses compared with the truth."""

    def check(self, name, sequence, align, *arguments):
        out = WORK / name
        out.mkdir()
        scene = make_scene(out)
        planecast("run", sequence, "--scene", scene, "-o", out, "--quiet", *arguments)
        self.assertEqual(frame_count(out / "augmented.mp4"), FRAMES)
        for file in ("trajectory.txt", "trajectory_causal.txt", "keyframes.txt", "planes.json",
                     "map.ply", "map.bin", "scene.glb", "frames.csv", "times.csv", "timings.json",
                     "summary.json", "report.html"):
            self.assertGreater((out / file).stat().st_size, 0, file)
        figures = out / "ate.json"
        planecast("evaluate", "trajectory", "--estimate", out / "trajectory.txt", "--groundtruth",
                  TABLETOP / "groundtruth.txt", "--align", align, "--json", figures)
        result = json.loads(figures.read_text(encoding="utf-8"))
        self.assertGreaterEqual(result["pairs"], 0.95 * FRAMES)
        self.assertLess(result["ate_m"]["rmse"], MAX_ATE_M)
        planes = json.loads((out / "planes.json").read_text(encoding="utf-8"))["planes"]
        self.assertTrue({plane["class"] for plane in planes} & {"horizontal", "floor"}, planes)
        return out

    def test_tum_folder_mono(self):
        self.check("mono", TABLETOP, "sim3", "--mode", "mono", "--segmentation", "none")

    def test_tum_folder_rgbd_with_depth_occlusion(self):
        out = self.check("rgbd", TABLETOP, "se3", "--mode", "rgbd", "--segmentation", "masks", "--png")
        self.assertEqual(len(list((out / "frames").glob("*.png"))), FRAMES)

    def test_image_folder(self):
        self.check("folder", WORK / "images", "sim3", "--camera", INTRINSICS)

    def test_video_file(self):
        self.check("video", WORK / "clip.mp4", "sim3", "--camera", INTRINSICS)


class SameBytes(unittest.TestCase):
    def test_tracking_does_not_depend_on_threads(self):
        for threads in (1, 2):
            planecast("track", TABLETOP, "-o", WORK / f"threads{threads}", "--mode", "mono",
                      "--threads", threads, "--quiet")
        for file in ("trajectory.txt", "trajectory_causal.txt", "keyframes.txt", "frames.csv",
                     "planes.json", "map.ply", "map.bin"):
            self.assertEqual((WORK / "threads1" / file).read_bytes(),
                             (WORK / "threads2" / file).read_bytes(), file)

    def test_rendering_twice(self):
        scene = make_scene(WORK)
        planecast("track", TABLETOP, "-o", WORK / "once", "--mode", "rgbd", "--quiet")
        for name in ("render_a", "render_b"):
            planecast("render", TABLETOP, "--reconstruction", WORK / "once", "--scene", scene,
                      "-o", WORK / name, "--quiet")
        self.assertEqual((WORK / "render_a" / "augmented.mp4").read_bytes(),
                         (WORK / "render_b" / "augmented.mp4").read_bytes())


class BadInput(unittest.TestCase):
    """One line on stderr that names the file and the reason, exit status 2."""

    def refuse(self, *arguments, naming, command="run"):
        done = planecast(command, *arguments, "-o", WORK / "bad", "--quiet", expect=2)
        lines = done.stderr.strip().splitlines()
        self.assertEqual(len(lines), 1, done.stderr)
        for word in naming:
            self.assertIn(word, lines[0])

    def test_wrong_path(self):
        self.refuse("no/such/place", naming=["no/such/place"])

    def test_empty_folder(self):
        empty = WORK / "empty"
        empty.mkdir(exist_ok=True)
        self.refuse(empty, naming=[str(empty)])

    def test_truncated_png(self):
        folder = WORK / "truncated"
        shutil.copytree(WORK / "images", folder)
        victim = sorted(folder.iterdir())[10]
        victim.write_bytes(victim.read_bytes()[:2000])
        self.refuse(folder, "--camera", INTRINSICS, naming=[victim.name])

    def test_missing_camera_file(self):
        self.refuse(TABLETOP, "--camera", "lost.yaml", naming=["lost.yaml"])

    def test_unknown_scene_key(self):
        scene = make_scene(WORK, extra="    colour: red\n")
        self.refuse(TABLETOP, "--scene", scene, naming=["scene.yaml", "colour"])

    def test_broken_gltf(self):
        broken = WORK / "broken.glb"
        broken.write_bytes(b"glTF\x02\x00\x00\x00 this is not a model")
        scene = WORK / "broken.yaml"
        scene.write_text(
            f"objects:\n  - model: {broken}\n    place: {{frame: 20, pixel: [150, 160]}}\n",
            encoding="utf-8",
        )
        self.refuse(TABLETOP, "--scene", scene, "--mode", "rgbd", naming=["broken.glb"])

    def test_hit_test_beside_every_plane(self):
        scene = make_scene(WORK, place="{frame: 9999, pixel: [1, 1]}")
        self.refuse(TABLETOP, "--scene", scene, "--mode", "rgbd", naming=["9999"])

    def test_unknown_option(self):
        done = planecast("run", TABLETOP, "--no-such-option", expect=2)
        self.assertEqual(len(done.stderr.strip().splitlines()), 1, done.stderr)

    def test_no_camera_is_a_guess_and_one_warning(self):
        out = WORK / "guess"
        done = planecast("track", WORK / "images", "-o", out, "--no-progress")
        warnings = [line for line in done.stderr.splitlines() if "warning" in line]
        self.assertEqual(len(warnings), 1, done.stderr)
        self.assertIn("60 degrees", warnings[0])


if __name__ == "__main__":
    unittest.main(argv=[sys.argv[0], *sys.argv[3:]])
