#!/usr/bin/env python3
"""The command line itself: help, errors, JSON, progress, completion in Bash, the man page.

Usage: command_line_test.py PLANECAST WORK_FOLDER [unittest arguments]
"""

import json
import os
import pty
import re
import subprocess
import sys
import unittest

from cli import PLANECAST, ROOT, WORK, empty_work_folder, planecast

SEQUENCE = WORK / "tabletop"
FRAMES = 24


def setUpModule():
    empty_work_folder()
    planecast("synth", "tabletop", "-o", SEQUENCE, "--width", 160, "--height", 120, "--count", FRAMES,
              "--quiet")


def commands(*path):
    """Names of the commands below one, as its help lists them."""
    text = planecast(*path, "--help").stdout
    if "Subcommands:\n" not in text:
        return []
    block = text.split("Subcommands:\n")[1].split("\n\n")[0]
    return re.findall(r"^  (\S+)", block, re.MULTILINE)


def leaves(*path):
    below = commands(*path)
    return [leaf for name in below for leaf in leaves(*path, name)] if below else [path]


def bash_completion(words):
    """What Bash offers for the last of the words."""
    script = 'source <("$1" completion bash); shift; COMP_WORDS=("$@"); ' \
             'COMP_CWORD=$(($# - 1)); _planecast; printf "%s\\n" "${COMPREPLY[@]}"'
    done = subprocess.run(["bash", "-c", script, "bash", str(PLANECAST), "planecast", *words],
                          capture_output=True, text=True, cwd=ROOT, check=True)
    return [line.strip() for line in done.stdout.split("\n") if line.strip()]


class Help(unittest.TestCase):
    def test_every_command_has_usage_and_examples_that_name_it(self):
        found = leaves()
        self.assertGreaterEqual(len(found), 15, found)
        for path in found:
            text = planecast(*path, "--help").stdout
            name = "planecast " + " ".join(path)
            self.assertIn(f"Usage: {name}", text)
            self.assertIn("Examples:\n", text, name)
            self.assertIn(name, text.split("Examples:\n")[1], name)
            self.assertLessEqual(max(map(len, text.splitlines())), 100, name)

    def test_no_option_of_an_example_is_unknown(self):
        for path in leaves():
            text = planecast(*path, "--help").stdout
            examples = "\n".join(line for line in text.split("Examples:\n")[1].splitlines()
                                 if line.startswith("  planecast"))
            for option in re.findall(r"(?<=\s)--?[a-z][a-z-]*", examples):
                self.assertIn(option, text.split("Examples:\n")[0], path)

    def test_the_man_page_has_every_command_and_option(self):
        page = planecast("--help-man").stdout.replace("\\-", "-").replace("\\fR", "")
        for path in leaves():
            self.assertIn(f".SS planecast {' '.join(path)}\n", page)
            help_text = planecast(*path, "--help").stdout.split("Examples:\n")[0]
            for option in re.findall(r"^  .*?(--[a-z-]+)", help_text, re.MULTILINE):
                if option != "--help":
                    self.assertIn(f"\\fB{option}", page, path)

    def test_values_of_options(self):
        text = planecast("calibrate", "--help").stdout
        for words in ("--frames A:B", "--board chessboard|charuco", "--dictionary NAME",
                      "(3 to 500) (default: 40)"):
            self.assertIn(words, text)

    def test_version(self):
        self.assertRegex(planecast("--version").stdout, r"^planecast \d+\.\d+\.\d+\n$")


class Documentation(unittest.TestCase):
    def test_names_no_command_and_no_option_that_is_not_there(self):
        known = {" ".join(path): planecast(*path, "--help").stdout for path in leaves()}
        count = 0
        for page in (ROOT / "README.md", *(ROOT / "docs").glob("*.md")):
            for line in page.read_text(encoding="utf-8").splitlines():
                match = re.match(r" {4}(?:build/release/)?planecast ([a-z].*)", line)
                if not match:
                    continue
                words = match.group(1).split(" #")[0].split()
                path = next((p for p in (" ".join(words[:2]), words[0]) if p in known), None)
                self.assertIsNotNone(path, f"{page.name}: {line}")
                for word in words:
                    if re.match(r"--?[a-z]", word):
                        self.assertIn(word.split("=")[0], known[path], f"{page.name}: {line}")
                count += 1
        self.assertGreater(count, 10)


class BashCompletion(unittest.TestCase):
    def test_commands(self):
        self.assertEqual(bash_completion(["ru"]), ["run"])
        self.assertEqual(set(bash_completion([""])), set(commands()))
        self.assertEqual(set(bash_completion(["evaluate", ""])), set(commands("evaluate")))

    def test_options_of_the_command(self):
        self.assertEqual(bash_completion(["run", "desk", "--plane-m"]), ["--plane-merge"])
        self.assertEqual(bash_completion(["evaluate", "masks", "--est"]), ["--estimate"])
        self.assertNotIn("--estimate", bash_completion(["run", "--"]))

    def test_values(self):
        self.assertEqual(set(bash_completion(["track", "--mode", ""])), {"mono", "rgbd", "auto"})
        self.assertEqual(bash_completion(["track", "--mode", "=", "rg"]), ["rgbd"])
        self.assertEqual(bash_completion(["track", "--camera", "tum-fr3"]), ["tum-fr3"])
        self.assertEqual(bash_completion(["synth", "tablet"]), ["tabletop"])
        self.assertEqual(bash_completion(["run", "--scene", "README"]), ["README.md"])
        self.assertEqual(bash_completion(["track", "desk", "-o", "asse"]), ["assets"])
        self.assertEqual(bash_completion(["completion", "z"]), ["zsh"])
        self.assertEqual(bash_completion(["track", "--threads", ""]), [])


class Json(unittest.TestCase):
    def test_stdout_is_json_alone(self):
        names = json.loads(planecast("synth", "--list", "--json", "-").stdout)
        self.assertIn("tabletop", names)
        model = json.loads(planecast("model", "assets/models/robot.glb", "--json", "-").stdout)
        self.assertGreater(len(model["animations"]), 0)
        self.assertGreater(model["max"][1], model["min"][1])
        self.assertTrue(model["contents"])

    def test_a_file_beside_the_text(self):
        file = WORK / "track.json"
        done = planecast("track", SEQUENCE, "-o", WORK / "map", "--mode", "rgbd", "--json", file,
                         "--no-progress")
        self.assertEqual(done.stdout.strip(), str(WORK / "map"))
        figures = json.loads(file.read_text(encoding="utf-8"))
        self.assertEqual(figures["summary"]["frames"]["count"], FRAMES)
        self.assertFalse(figures["poor"])
        errors = json.loads(planecast("evaluate", "trajectory", "--estimate",
                                      WORK / "map" / "trajectory.txt", "--groundtruth", SEQUENCE,
                                      "--json", "-").stdout)
        self.assertLess(errors["ate_m"]["rmse"], 0.05)

    def test_run_and_render(self):
        run = json.loads(planecast("run", SEQUENCE, "-o", WORK / "run", "--mode", "rgbd", "--quiet",
                                   "--json", "-").stdout)
        self.assertEqual(run["rendering"]["frames"], FRAMES)
        self.assertEqual(run["rendering"]["video"], str(WORK / "run" / "augmented.mp4"))
        render = json.loads(planecast("render", SEQUENCE, "--reconstruction", WORK / "run", "-o",
                                      WORK / "render", "--quiet", "--json", "-").stdout)
        self.assertEqual(render["rendering"]["with_content"], run["rendering"]["with_content"])

    def test_segment(self):
        masks = json.loads(planecast("segment", SEQUENCE, "-o", WORK / "masks", "--frames", "2:4",
                                     "--quiet", "--json", "-").stdout)
        self.assertEqual([mask["frame"] for mask in masks["masks"]], [2, 3])
        self.assertGreater(masks["masks"][0]["instances"], 0)


class Errors(unittest.TestCase):
    """One line, exit 2, and the words that tell what is wrong."""

    def refuse(self, *arguments, words):
        done = planecast(*arguments, expect=2)
        self.assertEqual(len(done.stderr.strip().splitlines()), 1, done.stderr)
        self.assertTrue(done.stderr.startswith("planecast: "), done.stderr)
        for word in words:
            self.assertIn(word, done.stderr)

    def test_usage(self):
        for arguments, words in (
            ((), ["subcommand"]),
            (("rnu",), ["unknown command 'rnu'"]),
            (("run",), ["sequence is required"]),
            (("run", SEQUENCE, "--mode", "stereo"), ["--mode", "stereo"]),
            (("run", SEQUENCE, "--frames", "9:3"), ["--frames 9:3"]),
            (("run", SEQUENCE, "--size", "big"), ["--size big"]),
            (("track", SEQUENCE), ["--output"]),
            (("track", SEQUENCE, "-o", WORK / "x", "--threads", "0"), ["--threads"]),
            (("track", SEQUENCE, "-o", WORK / "x", "--quiet", "--verbose"), ["--verbose"]),
            (("evaluate",), ["subcommand"]),
            (("synth", "moon", "-o", WORK / "x"), ["moon"]),
            (("synth", "tabletop"), ["-o"]),
            (("completion", "tcsh"), ["tcsh"]),
            (("calibrate",), ["no recording"]),
            (("calibrate", SEQUENCE, "--squares", "ten"), ["--squares ten"]),
        ):
            with self.subTest(arguments=arguments):
                self.refuse(*arguments, words=words)

    def test_files(self):
        photo = next((SEQUENCE / "rgb").iterdir())
        (WORK / "file").write_text("not a folder", encoding="utf-8")
        for arguments, words in (
            (("run", "nowhere"), ["nowhere", "no such"]),
            (("track", SEQUENCE, "-o", WORK / "file"), [str(WORK / "file")]),
            (("segment", photo, "--segmentation", "depth", "-o", WORK / "x"), [photo.name, "depth"]),
            (("render", SEQUENCE, "--reconstruction", "nowhere", "-o", WORK / "x"), ["nowhere"]),
            (("model", "README.md"), ["README.md"]),
            (("benchmark", "nowhere.yaml", "-o", WORK / "x"), ["nowhere.yaml"]),
            (("evaluate", "planes", "--reconstruction", WORK, "--groundtruth", SEQUENCE), [str(WORK)]),
            (("synth", "--list", "--json", WORK / "no" / "folder.json"), ["folder.json"]),
            (("calibrate", SEQUENCE, "--squares", "10x7", "--no-progress"), [str(SEQUENCE), "0 frames"]),
        ):
            with self.subTest(arguments=arguments):
                self.refuse(*arguments, words=words)


class Calibrate(unittest.TestCase):
    def test_a_board_to_print(self):
        for kind in ("chessboard", "charuco"):
            board = WORK / f"{kind}.png"
            planecast("calibrate", "--draw-board", board, "--board", kind, "--squares", "8x6")
            self.assertEqual(board.read_bytes()[:8], b"\x89PNG\r\n\x1a\n")


class Progress(unittest.TestCase):
    ARGUMENTS = ("synth", "tabletop", "-o", WORK / "again", "--width", "64", "--height", "48",
                 "--count", "20")

    def test_a_line_every_tenth_without_a_terminal(self):
        lines = planecast(*self.ARGUMENTS).stderr.splitlines()
        self.assertEqual(len(lines), 10, lines)
        self.assertEqual(lines[0], "making: 10 % (2 of 20)")
        self.assertEqual(planecast(*self.ARGUMENTS, "--no-progress").stderr, "")

    def test_a_bar_on_a_terminal(self):
        main, side = pty.openpty()
        process = subprocess.Popen([str(PLANECAST), *map(str, self.ARGUMENTS)], cwd=ROOT,
                                   stderr=side, stdout=subprocess.DEVNULL)
        os.close(side)
        text = b""
        try:
            while block := os.read(main, 65536):
                text += block
        except OSError:  # the other end was closed
            pass
        self.assertEqual(process.wait(), 0)
        os.close(main)
        self.assertRegex(text.decode(), r"\rmaking +\[#+\.*\] \d+/20  \d+\.\d fps  \d+:\d\d left")
        self.assertIn("20/20", text.decode())


if __name__ == "__main__":
    unittest.main(argv=[sys.argv[0], *sys.argv[3:]])
