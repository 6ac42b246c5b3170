#!/usr/bin/env python3
"""Installs the build into an empty prefix, links a small program with it, makes the Debian packages
and runs one in a bare Debian 12.

Usage: install_test.py PLANECAST WORK_FOLDER [unittest arguments]
The build folder is that of PLANECAST. Needs dpkg-dev, debootstrap, root and Debian's mirror.
PLANECAST_MIRROR names another mirror than deb.debian.org.
"""

import gzip
import json
import os
import shutil
import subprocess
import sys
import unittest

from cli import PLANECAST, ROOT, WORK, empty_work_folder

BUILD = PLANECAST.parent
PREFIX = WORK / "prefix"
SEQUENCE = WORK / "tabletop"
MIRROR = os.environ.get("PLANECAST_MIRROR", "http://deb.debian.org/debian")


def run(*command, expect=0, **options):
    done = subprocess.run([str(word) for word in command], capture_output=True, text=True,
                          timeout=1800, **options)
    if done.returncode != expect:
        raise AssertionError(f"{command}: exit {done.returncode}\n{done.stdout}\n{done.stderr}")
    return done


def setUpModule():
    empty_work_folder()
    run("cmake", "--install", BUILD, "--prefix", PREFIX)
    planecast("synth", "tabletop", "-o", SEQUENCE, "--width", 160, "--height", 120, "--count", 16)


def planecast(*arguments):
    """The installed one, from an empty folder, so that nothing of the source is found by chance."""
    env = {"PATH": "/usr/bin:/bin", "HOME": str(WORK)}
    return run(PREFIX / "bin" / "planecast", *arguments, cwd=WORK, env=env)


class Installed(unittest.TestCase):
    def test_finds_its_assets(self):
        done = planecast("run", SEQUENCE, "-o", WORK / "run", "--mode", "rgbd", "--json", "-")
        self.assertGreater(json.loads(done.stdout)["rendering"]["with_content"], 0)
        planecast("golden", "init", WORK / "golden")
        run(sys.executable, PREFIX / "bin" / "planecast-batch", "--help")

    def test_manual_and_completions_are_in_place(self):
        share = PREFIX / "share"
        page = gzip.decompress((share / "man/man1/planecast.1.gz").read_bytes()).decode()
        self.assertIn(".SS planecast golden check", page)
        for file, words in (("bash-completion/completions/planecast", "complete -F"),
                            ("zsh/vendor-completions/_planecast", "#compdef planecast"),
                            ("fish/vendor_completions.d/planecast.fish", "complete -c planecast")):
            self.assertIn(words, (share / file).read_text(encoding="utf-8"))

    def test_another_program_links_with_it(self):
        folder = WORK / "consumer"
        run("cmake", "-S", ROOT / "test/integration/consumer", "-B", folder,
            f"-DCMAKE_PREFIX_PATH={PREFIX}", "-DCMAKE_BUILD_TYPE=Release")
        run("cmake", "--build", folder)
        env = {**os.environ, "PLANECAST_ASSETS": str(PREFIX / "share/planecast/assets")}
        done = run(folder / "consumer", SEQUENCE, cwd=WORK, env=env)
        self.assertRegex(done.stdout, r"^16 frames, [1-9]\d* planes\n$")


class DebianPackage(unittest.TestCase):
    @classmethod
    def setUpClass(cls):
        run("cpack", "-G", "DEB", "-B", WORK / "packages", cwd=BUILD)
        cls.packages = {path.name.split("_")[0]: path for path in (WORK / "packages").glob("*.deb")}

    def test_control_files(self):
        self.assertEqual(set(self.packages), {"planecast", "libplanecast-dev"})
        depends = run("dpkg-deb", "--field", self.packages["planecast"], "Depends").stdout
        for library in ("libosmesa6", "libc6", "libopencv-core", "libyaml-cpp", "libavcodec"):
            self.assertIn(library, depends)
        self.assertNotIn("-dev", depends)
        listing = run("dpkg-deb", "--contents", self.packages["planecast"]).stdout
        for file in ("./usr/bin/planecast\n", "./usr/bin/planecast-batch\n",
                     "./usr/share/man/man1/planecast.1.gz\n",
                     "./usr/share/planecast/assets/models/robot.glb\n",
                     "./usr/share/doc/planecast/copyright\n"):
            self.assertIn(file, listing)
        self.assertNotIn(".a\n", listing)

    def test_installs_and_runs_on_a_bare_debian(self):
        root = WORK / "debian"
        run("debootstrap", "--variant=minbase", "--include=ca-certificates", "bookworm", root, MIRROR)
        self.addCleanup(shutil.rmtree, root, ignore_errors=True)
        shutil.copy(self.packages["planecast"], root / "planecast.deb")
        shutil.copy("/etc/resolv.conf", root / "etc/resolv.conf")
        for file in ("apt.conf", "apt.conf.d/99proxy"):
            if os.path.isfile(f"/etc/apt/{file}"):
                shutil.copy(f"/etc/apt/{file}", root / "etc/apt" / file)
        inside = ["chroot", root, "env", "DEBIAN_FRONTEND=noninteractive", "HOME=/root",
                  "PATH=/usr/sbin:/usr/bin:/sbin:/bin"]
        run(*inside, "apt-get", "install", "-y", "--no-install-recommends", "./planecast.deb")
        run(*inside, "planecast", "synth", "tabletop", "-o", "/tmp/table", "--width", "160",
            "--height", "120", "--count", "16")
        done = run(*inside, "planecast", "run", "/tmp/table", "-o", "/tmp/out", "--json", "-")
        self.assertGreater(json.loads(done.stdout)["rendering"]["with_content"], 0)
        self.assertGreater((root / "tmp/out/augmented.mp4").stat().st_size, 1000)
        run(*inside, "apt-get", "remove", "-y", "planecast")
        self.assertFalse((root / "usr/share/planecast").exists())


if __name__ == "__main__":
    unittest.main(argv=[sys.argv[0], *sys.argv[3:]])
