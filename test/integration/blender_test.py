#!/usr/bin/env python3
"""Opens scene.glb in Debian's Blender and compares where its camera sees the planes' corners with where
the reconstruction has them, frame by frame.

Usage: blender_test.py PLANECAST WORK_FOLDER [unittest arguments]
"""

import json
import os
import re
import shutil
import subprocess
import sys
import unittest

from cli import ROOT, WORK, empty_work_folder, planecast
from vectors import rotate_back, subtract

FRAMES = 40
MAX_ERROR_PX = 1.0
SCRIPT = ROOT / "scripts" / "match_move_in_blender.py"


def poses_by_frame(folder):
    """World from camera, by frame, of those that have one."""
    rows = (folder / "frames.csv").read_text(encoding="utf-8").splitlines()[1:]
    frame_of = {float(row.split(",")[1]): int(row.split(",")[0]) for row in rows}
    poses = {}
    for line in (folder / "trajectory.txt").read_text(encoding="utf-8").splitlines():
        if line.startswith("#"):
            continue
        numbers = list(map(float, line.split()))
        nearest = min(frame_of, key=lambda time: abs(time - numbers[0]))
        poses[frame_of[nearest]] = numbers[1:]
    return poses


def camera_of(folder):
    data = (folder / "scene.glb").read_bytes()
    length = int.from_bytes(data[12:16], "little")
    document = json.loads(data[20:20 + length])
    return document["cameras"][0]["extras"]


def project(camera, pose, point):
    x, y, z = rotate_back(pose[3:], subtract(point, pose[:3]))
    if z < 0.1:
        return None
    return [camera["fx"] * x / z + camera["cx"], camera["fy"] * y / z + camera["cy"]]


@unittest.skipIf(shutil.which("blender") is None,
                 "skipped: apt-get install --no-install-recommends blender python3-numpy")
class InBlender(unittest.TestCase):
    def check(self, name, intrinsics):
        sequence = WORK / name
        planecast("synth", "tabletop", "-o", sequence, "--width", 320, "--height", 240,
                  "--count", FRAMES, "--quiet")
        camera_file = sequence / "camera.yaml"
        text = camera_file.read_text(encoding="utf-8")
        for key, value in intrinsics.items():
            text = re.sub(rf"^{key}: .*$", f"{key}: {value}", text, flags=re.M)
        camera_file.write_text(text, encoding="utf-8")
        out = WORK / f"{name}-track"
        planecast("track", sequence, "-o", out, "--quiet")
        camera = camera_of(out)
        poses = poses_by_frame(out)
        planes = json.loads((out / "planes.json").read_text(encoding="utf-8"))["planes"]
        points = [corner for plane in planes for corner in plane["polygon"]][:200]
        frames = sorted(poses)[::7]
        request = WORK / f"{name}-request.json"
        request.write_text(json.dumps({"frames": frames, "points": points}), encoding="utf-8")
        answer = WORK / f"{name}-answer.json"
        done = subprocess.run(
            ["blender", "-b", "--python-exit-code", "1", "-P", str(SCRIPT), "--",
             str(out / "scene.glb"), "--pixels", str(request), str(answer)],
            capture_output=True, text=True, timeout=600,
            # Blender's own interpreter takes its modules from where the first python in PATH has them.
            env={**os.environ, "PATH": "/usr/local/bin:/usr/bin:/bin"})
        self.assertEqual(done.returncode, 0, done.stdout + done.stderr)
        seen = json.loads(answer.read_text(encoding="utf-8"))
        compared = 0
        worst = 0.0
        for frame, row in zip(frames, seen):
            for point, pixel in zip(points, row):
                expected = project(camera, poses[frame], point)
                if expected is None or not (-50 < expected[0] < 370 and -50 < expected[1] < 290):
                    continue
                worst = max(worst, abs(pixel[0] - expected[0]), abs(pixel[1] - expected[1]))
                compared += 1
        print(f"{name}: {compared} corners, at most {worst:.3f} px off")
        self.assertGreater(compared, 100)
        self.assertLess(worst, MAX_ERROR_PX)

    def test_camera_sees_what_the_reconstruction_has(self):
        self.check("as-it-is", {})

    def test_off_centre_with_other_frame_rate(self):
        # Rendered with another centre than the file says: the poses are odd, the projection is not.
        self.check("off-centre", {"cx": 166.0, "cy": 113.0, "fy": 268.0, "fps": 24})


if __name__ == "__main__":
    empty_work_folder()
    unittest.main(argv=[sys.argv[0]] + sys.argv[3:])
