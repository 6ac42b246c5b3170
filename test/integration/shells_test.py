#!/usr/bin/env python3
"""Completion as Zsh and Fish do it, and the man page through its formatters.

Usage: shells_test.py PLANECAST WORK_FOLDER [unittest arguments]
Needs zsh, fish, mandoc and groff. Bash is tested in command_line_test.py.
"""

import os
import subprocess
import sys
import unittest

from cli import PLANECAST, ROOT, WORK, empty_work_folder, planecast

# Zsh completes only for someone who types: a pseudo-terminal of its own, where listing is turned
# into lines between marks.
ZSH = r"""
zmodload zsh/zpty
zpty shell zsh -f -i
zpty -w shell "PS1= PS2= PROMPT_EOL_MARK="
zpty -w shell "autoload -Uz compinit && compinit -u -D"
zpty -w shell "compadd() { local -a found; builtin compadd -O found \"\$@\"; print -rl -- OFFER\${^found}; builtin compadd \"\$@\" }"
zpty -w shell "source $1"
zpty -w shell "bindkey '^I' list-choices; print READY"
zpty -r -m shell line "*READY*" || exit 3
zpty -w -n shell "$2"$'\t'
sleep 3
zpty -w -n shell $'\x15'"print ENDED"$'\n'
while zpty -r shell line; do print -r -- "$line"; [[ $line == *ENDED ]] && break; done
zpty -d shell
"""


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
                         {"trajectory", "planes", "overlay", "masks"})
        self.assertEqual(self.offers("planecast run desk --plane-m"), ["--plane-merge"])
        self.assertEqual(set(self.offers("planecast track --mode ")), {"auto", "mono", "rgbd"})
        self.assertEqual(self.offers("planecast synth tablet"), ["tabletop"])
        self.assertIn("README.md", self.offers("planecast run --scene READ"))
        self.assertEqual(self.offers("planecast evaluate masks --est"), ["--estimate"])


class Zsh(unittest.TestCase):
    def offers(self, line):
        done = subprocess.run(["zsh", "-f", "-c", ZSH, "zsh", str(WORK / "planecast.zsh"), line],
                              capture_output=True, text=True, cwd=ROOT, timeout=120, check=True,
                              env={**os.environ, "HOME": str(WORK), "TERM": "dumb"})
        found = [part.strip() for part in done.stdout.replace("\r", "\n").split("\n")]
        return {part[len("OFFER"):] for part in found if part.startswith("OFFER")}

    def test_the_script_is_valid(self):
        subprocess.run(["zsh", "-n", str(WORK / "planecast.zsh")], check=True)

    def test_commands_options_and_values(self):
        self.assertIn("run", self.offers("planecast ru"))
        self.assertEqual(self.offers("planecast evaluate ") & {"planes", "run"}, {"planes"})
        self.assertIn("--plane-merge", self.offers("planecast run desk --plane-m"))
        self.assertLessEqual({"mono", "rgbd", "auto"}, self.offers("planecast track --mode "))
        self.assertIn("tabletop", self.offers("planecast synth tablet"))


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
