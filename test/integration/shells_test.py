#!/usr/bin/env python3
"""Completion as Zsh and Fish do it, and the man page through its formatters.

Usage: shells_test.py PLANECAST WORK_FOLDER [unittest arguments]
Needs zsh, fish, mandoc and groff. Bash is tested in command_line_test.py.
"""

import os
import pty
import select
import subprocess
import sys
import time
import unittest

from cli import PLANECAST, ROOT, WORK, empty_work_folder, planecast

# Zsh completes only for someone who types. What it would offer is printed on lines of its own.
ZSH_SETUP = r"""
PS1= PS2= PROMPT_EOL_MARK=
autoload -Uz compinit && compinit -u -D
compadd() {
  if (( ${@[(I)-[OAD]]} )); then builtin compadd "$@"; return; fi
  local -a found
  builtin compadd -O found "$@"
  print -rl -- "" OFFER${^found}
  builtin compadd "$@"
}
source planecast.zsh
cd %s
"""


class TypingZsh:
    """An interactive Zsh on a terminal of its own."""

    def __init__(self):
        self.terminal, side = pty.openpty()
        self.process = subprocess.Popen(
            ["zsh", "-f", "-i"], stdin=side, stdout=side, stderr=side, cwd=WORK,
            start_new_session=True, env={**os.environ, "HOME": str(WORK), "TERM": "dumb"})
        os.close(side)

    def type(self, text):
        os.write(self.terminal, text.encode())

    def read_until(self, mark, seconds=30):
        text = ""
        end = time.monotonic() + seconds
        while mark not in text and time.monotonic() < end:
            if select.select([self.terminal], [], [], 0.1)[0]:
                text += os.read(self.terminal, 65536).decode(errors="replace")
        return text

    def offers(self, line):
        # The quotes keep the shell's echo of the command from being taken for its output.
        self.type(line + "\t")
        time.sleep(1.5)
        self.type("\x15print EN''DED\n")
        text = self.read_until("ENDED").replace("\r", "\n")
        words = (part.strip() for part in text.split("\n"))
        return {word[len("OFFER"):] for word in words if word.startswith("OFFER")}

    def close(self):
        self.type("exit\n")
        self.process.wait(timeout=30)
        os.close(self.terminal)


def setUpModule():
    empty_work_folder()
    for shell in ("zsh", "fish"):
        script = WORK / f"planecast.{shell}"
        script.write_text(planecast("completion", shell).stdout, encoding="utf-8")
    (WORK / "planecast.1").write_text(planecast("--help-man").stdout, encoding="utf-8")


class Fish(unittest.TestCase):
    def offers(self, line):
        env = {**os.environ, "HOME": str(WORK), "PATH": f"{PLANECAST.parent}:{os.environ['PATH']}"}
        done = subprocess.run(["fish", "-c", f"source {WORK}/planecast.fish; complete -C '{line}'"],
                              capture_output=True, text=True, cwd=ROOT, env=env, check=True)
        return [offer.split("\t")[0] for offer in done.stdout.splitlines()]

    def test_commands_options_and_values(self):
        self.assertEqual(self.offers("planecast ru"), ["run"])
        self.assertEqual(set(self.offers("planecast evaluate ")),
                         {"trajectory", "planes", "overlay", "masks", "tracks"})
        self.assertEqual(self.offers("planecast run desk --plane-m"), ["--plane-merge"])
        self.assertEqual(set(self.offers("planecast track --mode ")), {"auto", "mono", "rgbd"})
        self.assertEqual(self.offers("planecast synth tablet"), ["tabletop"])
        self.assertIn("README.md", self.offers("planecast run --scene READ"))
        self.assertEqual(self.offers("planecast evaluate masks --est"), ["--estimate"])


class Zsh(unittest.TestCase):
    def test_the_script_is_valid(self):
        subprocess.run(["zsh", "-n", str(WORK / "planecast.zsh")], check=True)

    def test_commands_options_and_values(self):
        (WORK / "setup").write_text(ZSH_SETUP % ROOT, encoding="utf-8")
        shell = TypingZsh()
        self.addCleanup(shell.close)
        shell.type("source setup; print REA''DY\n")
        self.assertIn("READY", shell.read_until("READY"))
        for line, offered in (("planecast ru", {"run"}),
                              ("planecast evaluate ", {"trajectory", "planes", "overlay", "masks", "tracks"}),
                              ("planecast run desk --plane-m", {"--plane-merge"}),
                              ("planecast track --mode ", {"mono", "rgbd", "auto"}),
                              ("planecast synth tablet", {"tabletop"}),
                              ("planecast track --camera tum-fr", {"tum-fr1", "tum-fr2", "tum-fr3"}),
                              ("planecast run --scene READ", {"README.md"})):
            with self.subTest(line=line):
                self.assertEqual(shell.offers(line), offered)


class ManPage(unittest.TestCase):
    def test_formatters_find_no_fault(self):
        page = str(WORK / "planecast.1")
        done = subprocess.run(["groff", "-man", "-ww", "-Tutf8", page], capture_output=True,
                              text=True, check=True)
        self.assertEqual(done.stderr, "")
        self.assertIn("planecast golden check", done.stdout)
        done = subprocess.run(["mandoc", "-Tlint", "-Werror", page], capture_output=True, text=True,
                              check=False)
        self.assertEqual(done.returncode, 0, done.stdout + done.stderr)


if __name__ == "__main__":
    unittest.main(argv=[sys.argv[0], *sys.argv[3:]])
