#!/usr/bin/env python3
"""Every fault that docs/reliability.md lists: bad input is refused by one line that names the file, or
warned of and passed over; nothing crashes, hangs, or takes the place of what was written before.

Usage: faults_test.py PLANECAST WORK_FOLDER [unittest arguments]
"""

import json
import os
import pathlib
import resource
import shutil
import struct
import subprocess
import sys
import unittest
import zlib

from cli import PLANECAST, ROOT, WORK, empty_work_folder, planecast

SEQUENCE = WORK / "tabletop"
FRAMES = 40
MIDDLE = 25
# A reader that hangs is ended by this, and the test with it.
PATIENCE_S = 120
# What any of these may take at its peak: libraries alone are 250 MB.
MEMORY_MB = 1500


def setUpModule():
    empty_work_folder()
    planecast("synth", "tabletop", "-o", SEQUENCE, "--width", 160, "--height", 120, "--count", FRAMES,
              "--quiet")


def run(*arguments, **options):
    """Exit status and lines of stderr."""
    process = subprocess.Popen([str(PLANECAST), *map(str, arguments)], cwd=ROOT, stderr=subprocess.PIPE,
                               stdout=subprocess.DEVNULL, stdin=subprocess.DEVNULL, **options)
    try:
        text = process.communicate(timeout=PATIENCE_S)[1]
    finally:
        process.kill()
    return process.returncode, text.decode(errors="replace").strip().splitlines()


def chunk(kind, body):
    return struct.pack(">I", len(body)) + kind + body + struct.pack(">I", zlib.crc32(kind + body))


def png(width, height, data=None, color=2):
    """A grey or colour picture; `data` instead of its pixels makes a liar."""
    if data is None:
        data = (b"\0" + bytes([120]) * (width * (3 if color == 2 else 1))) * height
    return (b"\x89PNG\r\n\x1a\n" + chunk(b"IHDR", struct.pack(">IIBBBBB", width, height, 8, color, 0, 0, 0))
            + chunk(b"IDAT", zlib.compress(data, 1)) + chunk(b"IEND", b""))


def bmp(width, height):
    return (b"BM" + struct.pack("<IHHI", 54, 0, 0, 54)
            + struct.pack("<IiiHHIIiiII", 40, width, height, 1, 24, 1, 0, 0, 0, 0, 0) + b"\0" * 64)


def tiff(width, height):
    entries = [(256, 4, width), (257, 4, height), (258, 3, 8), (259, 3, 1), (262, 3, 1), (273, 4, 8),
               (277, 3, 1), (278, 4, height), (279, 4, 8)]
    table = b"".join(struct.pack("<HHI", tag, kind, 1) + (struct.pack("<I", value) if kind == 4
                                                          else struct.pack("<HH", value, 0))
                     for tag, kind, value in entries)
    return b"II*\0" + struct.pack("<IQH", 16, 0, len(entries)) + table + struct.pack("<I", 0)


def frames_of(folder, column="state"):
    lines = (folder / "frames.csv").read_text(encoding="utf-8").splitlines()
    index = lines[0].split(",").index(column)
    return [line.split(",")[index] for line in lines[1:]]


def video_frames(video):
    done = subprocess.run(["ffprobe", "-v", "error", "-count_frames", "-select_streams", "v:0",
                           "-show_entries", "stream=nb_read_frames", "-of", "csv=p=0", str(video)],
                          capture_output=True, text=True, check=True)
    return int(done.stdout.strip().strip(","))


class Fault(unittest.TestCase):
    def setUp(self):
        self.folder = WORK / self.id().split(".", 1)[1].replace(".", "_")
        self.folder.mkdir()
        self.out = self.folder / "out"

    def sequence(self):
        """A copy of the good one, to be spoiled."""
        folder = self.folder / "sequence"
        shutil.copytree(SEQUENCE, folder, copy_function=os.link)
        return folder

    def replace(self, path, data):
        path.unlink()
        path.write_bytes(data)
        return path

    def picture(self, folder, number, kind="rgb"):
        return sorted((folder / kind).iterdir())[number]

    def images(self, *pictures):
        folder = self.folder / "images"
        folder.mkdir()
        for number, data in enumerate(pictures):
            (folder / f"{number:04}.png").write_bytes(data)
        return folder

    def refused(self, *arguments, naming, **options):
        status, lines = run(*arguments, **options)
        lines = [line for line in lines if not line.startswith("warning: ")]
        self.assertEqual(status, 2, lines)
        self.assertEqual(len(lines), 1, lines)
        self.assertTrue(lines[0].startswith("planecast: "), lines)
        for word in [naming] if isinstance(naming, (str, pathlib.Path)) else naming:
            self.assertIn(str(word), lines[0])
        return lines[0]

    def accepted(self, *arguments, status=0, warning=None):
        done, lines = run(*arguments, "--no-progress")
        self.assertEqual(done, status, lines)
        if warning:
            self.assertTrue([line for line in lines if "warning: " in line and warning in line], lines)

    def go(self, sequence, *arguments):
        return ("run", sequence, "-o", self.out, *arguments)


class Frames(Fault):
    """Pictures and their order."""

    def check_ends_at(self, sequence, naming):
        self.refused(*self.go(sequence, "--quiet"), naming=naming)
        self.assertEqual(len(frames_of(self.out)), MIDDLE)
        self.assertEqual(video_frames(self.out / "augmented.mp4"), MIDDLE)
        shutil.rmtree(self.out)
        self.accepted(*self.go(sequence, "--skip-unreadable"), status=1, warning=f"frame {MIDDLE} ")
        self.assertEqual(frames_of(self.out).index("unreadable"), MIDDLE)
        self.assertEqual(video_frames(self.out / "augmented.mp4"), FRAMES)

    def test_unreadable_in_the_middle(self):
        sequence = self.sequence()
        victim = self.picture(sequence, MIDDLE)
        self.replace(victim, victim.read_bytes()[:700])
        self.check_ends_at(sequence, victim.name)

    def test_missing_in_the_middle(self):
        sequence = self.sequence()
        victim = self.picture(sequence, MIDDLE)
        victim.unlink()
        self.check_ends_at(sequence, victim.name)

    def test_another_size_in_the_middle(self):
        sequence = self.sequence()
        victim = self.replace(self.picture(sequence, MIDDLE), png(80, 60))
        self.check_ends_at(sequence, [victim.name, "80x60", "160x120"])

    def test_a_depth_picture_that_is_missing(self):
        sequence = self.sequence()
        victim = self.picture(sequence, MIDDLE, "depth")
        victim.unlink()
        self.check_ends_at(sequence, victim.name)

    def test_a_frame_without_depth(self):
        sequence = self.sequence()
        lines = (sequence / "depth.txt").read_text(encoding="utf-8").splitlines(True)
        self.replace(sequence / "depth.txt", "".join(lines[:MIDDLE] + lines[MIDDLE + 3:]).encode())
        self.accepted(*self.go(sequence, "--mode", "rgbd", "--no-video"))
        self.assertEqual(set(frames_of(self.out)), {"tracked"})

    def test_no_depth_at_all(self):
        sequence = self.sequence()
        (sequence / "depth.txt").unlink()
        self.refused(*self.go(sequence, "--mode", "rgbd"), naming=sequence)
        self.accepted(*self.go(sequence, "--no-video"))

    def test_a_time_that_is_there_twice(self):
        sequence = self.sequence()
        lines = (sequence / "rgb.txt").read_text(encoding="utf-8").splitlines(True)
        time = lines[MIDDLE - 1].split()[0]
        lines[MIDDLE] = f"{time} {lines[MIDDLE].split()[1]}\n"
        self.replace(sequence / "rgb.txt", "".join(lines).encode())
        self.refused(*self.go(sequence), naming=[f"rgb.txt:{MIDDLE + 1}", "twice"])

    def test_times_that_go_back(self):
        sequence = self.sequence()
        lines = (sequence / "rgb.txt").read_text(encoding="utf-8").splitlines(True)
        lines[MIDDLE], lines[MIDDLE + 5] = lines[MIDDLE + 5], lines[MIDDLE]
        self.replace(sequence / "rgb.txt", "".join(lines).encode())
        self.accepted(*self.go(sequence, "--no-video"))
        times = [float(time) for time in frames_of(self.out, "timestamp")]
        self.assertEqual(times, sorted(times))
        self.assertEqual(set(frames_of(self.out)), {"tracked"})

    def test_times_that_are_no_numbers(self):
        sequence = self.sequence()
        for time in ("nan", "inf", "1e999", "soon"):
            self.replace(sequence / "rgb.txt", f"0.0 rgb/a.png\n{time} rgb/b.png\n".encode())
            self.refused(*self.go(sequence), naming="rgb.txt:2")

    def test_no_frames(self):
        sequence = self.sequence()
        self.replace(sequence / "rgb.txt", b"# nothing\n")
        self.refused(*self.go(sequence), naming="rgb.txt")
        self.refused(*self.go(self.images()), naming="images")
        self.refused(*self.go(SEQUENCE, "--frames", "100:200"), naming=str(FRAMES))

    def test_one_frame(self):
        for name, *mode in (("mono", "--mode", "mono"), ("rgbd", "--mode", "rgbd")):
            self.out = self.folder / name
            self.accepted(*self.go(SEQUENCE, "--frames", "3:4", *mode), status=1 if name == "mono" else 0)
            self.assertEqual(video_frames(self.out / "augmented.mp4"), 1)

    def test_one_pixel(self):
        self.refused(*self.go(self.images(png(1, 1), png(1, 1))), naming=["images", "1x1"])

    def test_the_smallest_frames(self):
        self.accepted(*self.go(self.images(*[png(16, 16)] * 3)), status=1)

    def test_8k(self):
        images = self.images(*[png(7680, 4320, color=0)] * 2)
        self.accepted(*self.go(images), status=1)
        self.assertEqual(video_frames(self.out / "augmented.mp4"), 2)

    def test_black_and_without_texture(self):
        for name, value in (("black", 0), ("grey", 140)):
            picture = png(160, 120, (b"\0" + bytes([value]) * 480) * 120)
            images = self.folder / name
            images.mkdir()
            for number in range(12):
                (images / f"{number}.png").write_bytes(picture)
            self.out = self.folder / f"{name}_out"
            self.accepted(*self.go(images), status=1, warning="lost")
            self.assertEqual(video_frames(self.out / "augmented.mp4"), 12)


class Pictures(Fault):
    """Files that claim to be more than they are. A run reads the first frame's header before all."""

    def check_bomb(self, name, data):
        folder = self.folder / name
        folder.mkdir()
        (folder / name).write_bytes(data)
        before = resource.getrusage(resource.RUSAGE_CHILDREN).ru_maxrss
        self.refused("run", folder, "-o", self.out, naming=name)
        peak = resource.getrusage(resource.RUSAGE_CHILDREN).ru_maxrss
        self.assertLess(max(peak - before, 0) / 1024, MEMORY_MB)
        self.refused("segment", folder / name, "-o", self.out, naming=name)

    def test_bombs(self):
        self.check_bomb("wide.png", png(100000, 100000, b"\0" * 10000))
        self.check_bomb("square.png", png(16000, 16000, b"\0" * 10000))
        self.check_bomb("twice.png", png(60000, 60000, b"\0" * 100).replace(
            b"\x89PNG\r\n\x1a\n", b"\x89PNG\r\n\x1a\n" + chunk(b"IHDR", struct.pack(
                ">IIBBBBB", 64, 64, 8, 2, 0, 0, 0))))
        self.check_bomb("wide.bmp", bmp(200000, 200000))
        self.check_bomb("wide.tif", tiff(100000, 100000))
        self.check_bomb("map.png", b"P6\n30000 30000\n255\n" + b"\0" * 100)

    def test_a_pixel_of_a_liar(self):
        # All but its header is there for a picture of 64 x 64.
        folder = self.folder / "lies"
        folder.mkdir()
        (folder / "short.png").write_bytes(png(640, 480, b"\0" * 100))
        self.refused("run", folder, "-o", self.out, naming="short.png")

    def test_not_pictures(self):
        for name, data in (("empty.png", b""), ("text.jpg", b"not a picture"), ("half.jpg", b"\xff\xd8\xff\xe0")):
            with self.subTest(name=name):
                (self.folder / name).write_bytes(data)
                self.refused("segment", self.folder / name, "-o", self.out, naming=name)


class Videos(Fault):
    def clip(self, name, *options):
        path = self.folder / name
        subprocess.run(["ffmpeg", "-v", "error", "-framerate", "30", "-pattern_type", "glob", "-i",
                        f"{SEQUENCE}/rgb/*.png", "-c:v", "libx264", "-g", "5", *options, str(path)], check=True)
        return path

    def test_a_pipe_that_nobody_writes_to(self):
        pipe = self.folder / "pipe.mp4"
        os.mkfifo(pipe)
        self.refused(*self.go(pipe), naming=["pipe.mp4", "not a file"])
        self.refused(*self.go("/dev/zero"), naming="/dev/zero")
        for option in ("--scene", "--camera"):
            self.refused(*self.go(SEQUENCE, option, pipe), naming="pipe.mp4")
        self.refused("model", pipe, naming="pipe.mp4")

    def test_cut_off(self):
        clip = self.clip("late.mp4")
        (self.folder / "cut.mp4").write_bytes(clip.read_bytes()[: clip.stat().st_size // 2])
        self.refused(*self.go(self.folder / "cut.mp4"), naming="cut.mp4")

    def test_cut_off_behind_its_table(self):
        clip = self.clip("early.mp4", "-movflags", "+faststart")
        (self.folder / "cut.mp4").write_bytes(clip.read_bytes()[: clip.stat().st_size * 2 // 3])
        self.accepted("track", self.folder / "cut.mp4", "-o", self.out, "--camera", SEQUENCE / "camera.yaml",
                      warning="can be decoded")

    def test_text(self):
        (self.folder / "text.mp4").write_text("no video", encoding="utf-8")
        self.refused(*self.go(self.folder / "text.mp4"), naming="text.mp4")

    def test_a_playlist_opens_no_other_file(self):
        secret = self.clip("secret.mp4")
        for name, text in (("list.m3u8", f"#EXTM3U\n#EXTINF:1,\n{secret}\n"),
                           ("list.ffconcat", f"ffconcat version 1.0\nfile {secret}\n")):
            (self.folder / name).write_text(text, encoding="utf-8")
            self.refused(*self.go(self.folder / name), naming=name)


class Numbers(Fault):
    """Poses, cameras and results that hold no numbers."""

    def test_poses(self):
        for name, line in (("nan", "0.1 nan 0 0 0 0 0 1"), ("inf", "0.1 0 inf 0 0 0 0 1"),
                           ("zero", "0.1 0 0 0 0 0 0 0"), ("short", "0.1 0 0 0 0 0 1")):
            file = self.folder / f"{name}.txt"
            file.write_text(f"0.0 0 0 0 0 0 0 1\n{line}\n", encoding="utf-8")
            self.refused("evaluate", "trajectory", "--estimate", file, "--groundtruth", SEQUENCE,
                         naming=f"{name}.txt:2")
            self.refused("evaluate", "trajectory", "--estimate", SEQUENCE / "groundtruth.txt",
                         "--groundtruth", file, naming=f"{name}.txt:2")

    def test_cameras(self):
        good = (SEQUENCE / "camera.yaml").read_text(encoding="utf-8")
        for key, value in (("fx", ".nan"), ("fx", "-3"), ("cx", ".inf"), ("width", "0"), ("width", "1e300"),
                           ("depth_factor", "0"), ("fps", "-1")):
            with self.subTest(key=key, value=value):
                lines = [line for line in good.splitlines() if not line.startswith(f"{key}:")]
                file = self.folder / "camera.yaml"
                file.write_text("\n".join(lines + [f"{key}: {value}"]) + "\n", encoding="utf-8")
                self.refused(*self.go(SEQUENCE, "--camera", file), naming=["camera.yaml", key])

    def test_a_reconstruction_that_was_damaged(self):
        made = self.folder / "made"
        planecast("track", SEQUENCE, "-o", made, "--quiet", "--mode", "rgbd")
        for name, spoil in (
                ("trajectory.txt", lambda data: data.replace(b" 0.", b" nan ", 1)),
                ("frames.csv", lambda data: data[: len(data) // 2]),
                ("planes.json", lambda data: data[: len(data) // 2]),
                ("planes.json", lambda data: data.replace(b'"normal": [', b'"normal": ["x",', 1)),
                ("map.ply", lambda data: data[:-5]),
                ("map.bin", lambda data: data[:-5]),
                ("map.bin", lambda data: data[:500] + bytes([data[500] ^ 1]) + data[501:]),
                ("keyframes.txt", lambda data: b"0.512 0 0 0 0 0 0 1\n")):
            with self.subTest(name=name):
                folder = self.folder / "spoiled"
                shutil.copytree(made, folder)
                (folder / name).write_bytes(spoil((made / name).read_bytes()))
                self.refused("render", SEQUENCE, "--reconstruction", folder, "-o", self.out, naming=name)
                shutil.rmtree(folder)


def triangle():
    data = struct.pack("<9f", 0, 0, 0, 1, 0, 0, 0, 1, 0)
    return data, {
        "asset": {"version": "2.0"}, "scene": 0, "scenes": [{"nodes": [0]}], "nodes": [{"mesh": 0}],
        "meshes": [{"primitives": [{"attributes": {"POSITION": 0}, "material": 0}]}],
        "materials": [{"pbrMetallicRoughness": {"baseColorTexture": {"index": 0}}}],
        "textures": [{"source": 0}], "images": [{"uri": "picture.png"}],
        "buffers": [{"uri": "data.bin", "byteLength": len(data)}],
        "bufferViews": [{"buffer": 0, "byteLength": len(data)}],
        "accessors": [{"bufferView": 0, "componentType": 5126, "count": 3, "type": "VEC3"}],
    }


class Models(Fault):
    def setUp(self):
        super().setUp()
        data, self.model = triangle()
        (self.folder / "data.bin").write_bytes(data)
        (self.folder / "picture.png").write_bytes(png(4, 4))
        self.file = self.folder / "model.gltf"

    def write(self):
        self.file.write_text(json.dumps(self.model), encoding="utf-8")
        return self.file

    def refuse_model(self, naming="model.gltf"):
        self.refused("model", self.write(), "-o", self.folder / "model.png", naming=naming)
        self.assertFalse((self.folder / "model.png").exists())

    def test_good(self):
        self.accepted("model", self.write(), "-o", self.folder / "model.png")

    def test_nodes_in_a_circle(self):
        self.model["nodes"] = [{"children": [1], "mesh": 0}, {"children": [0]}]
        self.refuse_model(["model.gltf", "cycle"])
        self.model["nodes"] = [{"children": [0], "mesh": 0}]
        self.refuse_model(["model.gltf", "cycle"])

    def test_a_long_chain_of_nodes(self):
        self.model["nodes"] = [{"children": [i + 1]} for i in range(100000)] + [{"mesh": 0}]
        self.accepted("model", self.write())

    def test_files_that_are_not_beside_it(self):
        secret = WORK / "secret.bin"
        secret.write_bytes((self.folder / "data.bin").read_bytes())
        (self.folder / "below").mkdir()
        for uri in ("../secret.bin", "below/../../secret.bin", "%2e%2e/secret.bin", str(secret),
                    f"file://{secret}", f"http://localhost{secret}", "..\\secret.bin", "/dev/zero"):
            with self.subTest(uri=uri):
                self.model["buffers"][0]["uri"] = uri
                self.refuse_model()
        _, self.model = triangle()
        for uri in ("../secret.bin", str(secret), f"file://{secret}"):
            self.model["images"][0]["uri"] = uri
            self.accepted("model", self.write(), warning="the image is left out")

    def test_a_pipe_beside_it(self):
        os.mkfifo(self.folder / "pipe.bin")
        self.model["buffers"][0]["uri"] = "pipe.bin"
        self.refuse_model()

    def test_sizes_that_lie(self):
        for change in (lambda m: m["buffers"][0].update(byteLength=1 << 60),
                       lambda m: m["bufferViews"][0].update(byteLength=1 << 60),
                       lambda m: m["accessors"][0].update(count=1 << 40),
                       lambda m: m["accessors"][0].update(count=-1),
                       lambda m: m["bufferViews"][0].update(byteOffset=(1 << 64) - 4)):
            _, self.model = triangle()
            change(self.model)
            self.refuse_model()

    def test_a_file_of_gigabytes(self):
        with open(self.folder / "data.bin", "wb") as file:
            file.truncate(3 << 30)
        self.refuse_model("large")
        with open(self.folder / "huge.glb", "wb") as file:
            file.truncate(3 << 30)
        self.refused("model", self.folder / "huge.glb", naming="huge.glb")

    def test_many_elements_that_take_no_bytes(self):
        # An accessor without a view is all zeros: it costs the file nothing.
        self.model["accessors"] = [{"componentType": 5126, "count": 1 << 25, "type": "VEC3"}] * 40
        self.model["meshes"][0]["primitives"] = [{"attributes": {"POSITION": i}} for i in range(40)]
        self.refuse_model()

    def test_a_texture_that_is_a_bomb(self):
        (self.folder / "picture.png").write_bytes(png(60000, 60000, b"\0" * 1000))
        self.accepted("model", self.write(), warning="it is left out")

    def test_nested_deeply(self):
        self.file.write_text('{"asset": ' + "[" * 200000 + "]" * 200000 + "}", encoding="utf-8")
        self.refused("model", self.file, naming="model.gltf")


class Scenes(Fault):
    def test_nested_deeply(self):
        for name, text in (("list.yaml", "[" * 100000), ("map.yaml", "{a: " * 100000),
                           ("lines.yaml", "".join(" " * i + "a:\n" for i in range(3000)))):
            (self.folder / name).write_text(text, encoding="utf-8")
            self.refused(*self.go(SEQUENCE, "--scene", self.folder / name), naming=name)
            self.refused(*self.go(SEQUENCE, "--camera", self.folder / name), naming=name)

    def test_aliases_that_multiply(self):
        text = "a: &a [x, x, x, x, x, x, x, x, x]\n" + "".join(
            f"{c}: &{c} [{', '.join(['*' + chr(ord(c) - 1)] * 9)}]\n" for c in "bcdefghij")
        (self.folder / "laughs.yaml").write_text(text, encoding="utf-8")
        self.refused(*self.go(SEQUENCE, "--scene", self.folder / "laughs.yaml"), naming="laughs.yaml")


class Output(Fault):
    """Where it cannot be written, and what is there already."""

    def mounted(self, options, *arguments):
        """Runs with a file system of its own on the output folder, or skips where that is not allowed."""
        self.out.mkdir(exist_ok=True)
        script = 'mount -t tmpfs -o "$1" none "$2" || exit 77; shift 2; "$@"; status=$?; exit $status'
        done = subprocess.run(["unshare", "--user", "--map-root-user", "--mount", "sh", "-c", script, "sh",
                               options, str(self.out), str(PLANECAST), *map(str, arguments)], cwd=ROOT,
                              capture_output=True, text=True, timeout=PATIENCE_S, check=False)
        if done.returncode in (1, 77) and "planecast: " not in done.stderr:
            self.skipTest(f"no file system can be mounted here: {done.stderr}")
        return done

    def test_a_full_disk(self):
        # Beginning with one on which nothing has room, to one that fails in the midst of the video.
        for size in ("16k", "600k", "1500k"):
            with self.subTest(size=size):
                done = self.mounted(f"size={size}", *self.go(SEQUENCE, "--quiet", "--png"))
                lines = done.stderr.strip().splitlines()
                self.assertEqual(done.returncode, 2, lines)
                self.assertEqual(len(lines), 1, lines)
                self.assertRegex(lines[0], rf"^planecast: {self.out}.*No space left on device")

    def test_a_read_only_disk(self):
        done = self.mounted("ro", *self.go(SEQUENCE, "--quiet"))
        self.assertEqual(done.returncode, 2, done.stderr)
        self.assertRegex(done.stderr.strip(), rf"^planecast: {self.out}.*Read-only file system$")

    def test_a_limit_of_file_sizes(self):
        def limit():
            resource.setrlimit(resource.RLIMIT_FSIZE, (20000, 20000))
        planecast(*self.go(SEQUENCE), "--quiet")
        before = {path.name: path.read_bytes() for path in self.out.iterdir()}
        self.refused(*self.go(SEQUENCE, "--seed", "2", "--quiet"), naming=[self.out, "File too large"],
                     preexec_fn=limit)
        # Every file is either the one from before or a whole new one; none is half written.
        after = {path.name: path.read_bytes() for path in self.out.iterdir() if path.is_file()}
        self.assertEqual(set(before) - {"resume.txt"} - set(after), set())
        self.assertFalse([name for name in after if name.endswith(".part")])
        self.assertEqual(after["augmented.mp4"], before["augmented.mp4"])

    def test_no_place(self):
        (self.folder / "file").write_text("", encoding="utf-8")
        for place in ("/proc/planecast", self.folder / "file", self.folder / "file" / "below"):
            for command in (("run", SEQUENCE), ("track", SEQUENCE), ("segment", SEQUENCE),
                            ("synth", "tabletop", "--count", "2")):
                with self.subTest(place=place, command=command[0]):
                    self.refused(*command, "-o", place, "--quiet", naming=place)

    def test_names_that_are_no_text(self):
        name = os.fsdecode(b"t\xe4gel \xff\n")
        sequence = self.folder / name
        shutil.copytree(SEQUENCE, sequence, copy_function=os.link)
        (sequence / "depth.txt").unlink()
        out = self.folder / os.fsdecode(b"\xfcout")
        done, lines = run("run", sequence, "-o", out, "--no-progress", "--json", self.folder / "figures.json")
        self.assertEqual(done, 0, lines)
        json.loads((self.folder / "figures.json").read_bytes().decode("utf-8"))
        self.refused("run", sequence / name, "-o", out, naming="no such file")


if __name__ == "__main__":
    unittest.main(argv=[sys.argv[0], *sys.argv[3:]])
