#!/usr/bin/env python3
"""Runs scripts/batch by GNU parallel and by a Slurm of its own, one node on the loopback interface.

Usage: batch_test.py PLANECAST WORK_FOLDER [unittest arguments]
Needs parallel, slurmctld, slurmd, slurm-client and munge, and root to run the daemons.
"""

import csv
import os
import pathlib
import shutil
import socket
import subprocess
import sys
import time
import unittest

from cli import PLANECAST, ROOT, WORK, empty_work_folder, planecast

BATCH = ROOT / "scripts" / "batch"
SEQUENCES = WORK / "sequences.txt"
SCENES = WORK / "scenes.txt"


def batch(out, *arguments, expect=0, env=None):
    done = subprocess.run(
        [sys.executable, str(BATCH), "--sequences", str(SEQUENCES), "--scenes", str(SCENES), "-o",
         str(out), "--planecast", str(PLANECAST), "--track=--mode rgbd", *arguments],
        capture_output=True, text=True, timeout=900, env=env)
    if done.returncode != expect:
        raise AssertionError(f"exit {done.returncode}\n{done.stdout}\n{done.stderr}")
    return done


def rows(out):
    with open(out / "summary.csv", encoding="utf-8") as lines:
        return {(row["sequence"], row["scene"]): row for row in csv.DictReader(lines)}


def times(out):
    return {path: path.stat().st_mtime_ns for path in out.rglob("job.json")}


def setUpModule():
    empty_work_folder()
    for name, count in (("first", 16), ("second", 12)):
        planecast("synth", "tabletop", "-o", WORK / name, "--width", 160, "--height", 120, "--count",
                  count, "--quiet")
    for name in ("block", "vase"):
        (WORK / f"{name}.yaml").write_text(
            f"objects:\n  - model: {ROOT}/assets/models/{name}.glb\n    size: 0.2\n"
            "    place: {plane: largest-horizontal, at: [0.5, 0.5]}\n", encoding="utf-8")
    SEQUENCES.write_text(f"# two tables\n{WORK}/first\n{WORK}/second --frames 0:10\n",
                         encoding="utf-8")
    SCENES.write_text(f"{WORK}/block.yaml\n{WORK}/vase.yaml\n", encoding="utf-8")


class Batch(unittest.TestCase):
    """What both schedulers must do."""

    def check_all(self, out, *arguments, env=None):
        done = batch(out, *arguments, env=env)
        self.assertIn("4 done", done.stdout)
        table = rows(out)
        self.assertEqual(set(table), {(s, o) for s in ("first", "second") for o in ("block", "vase")})
        for (sequence, _), row in table.items():
            self.assertEqual(row["status"], "done")
            self.assertEqual(row["frames"], {"first": "16", "second": "10"}[sequence])
            self.assertGreater(int(row["with_content"]), 0)
            self.assertGreater(pathlib.Path(row["result"]).stat().st_size, 1000)
        self.assertIn("| first | block | done |", (out / "summary.md").read_text(encoding="utf-8"))

    def check_resume(self, out, *arguments, env=None):
        """Only what is not complete is done again: one render that was killed."""
        before = times(out)
        self.assertEqual(len(before), 6)
        killed = out / "first" / "vase" / "job.json"
        killed.unlink()
        batch(out, *arguments, env=env)
        after = times(out)
        self.assertEqual([path for path in after if after[path] != before[path]], [killed])


class Parallel(Batch):
    def test_parallel(self):
        out = WORK / "parallel"
        self.check_all(out)
        self.check_resume(out)
        # Another scene file: its two renders are not those that are there.
        text = (WORK / "vase.yaml").read_text(encoding="utf-8")
        (WORK / "vase.yaml").write_text(text.replace("0.2", "0.3"), encoding="utf-8")
        before = times(out)
        batch(out)
        (WORK / "vase.yaml").write_text(text, encoding="utf-8")
        changed = {path.parent.name for path, value in times(out).items() if value != before[path]}
        self.assertEqual(changed, {"vase"})

    def test_a_failing_job_is_a_row_and_not_the_end(self):
        broken = WORK / "broken.yaml"
        broken.write_text("objects:\n  - colour: red\n", encoding="utf-8")
        SCENES.write_text(f"{WORK}/block.yaml\n{broken}\n", encoding="utf-8")
        try:
            out = WORK / "failing"
            batch(out, expect=1)
        finally:
            SCENES.write_text(f"{WORK}/block.yaml\n{WORK}/vase.yaml\n", encoding="utf-8")
        table = rows(out)
        self.assertEqual(table["first", "block"]["status"], "done")
        self.assertEqual(table["first", "broken"]["status"], "failed")
        self.assertIn("broken.yaml:", table["first", "broken"]["reason"])

    def test_mistakes_are_one_line(self):
        for arguments, words in ((("--planecast", "nowhere"), "nowhere"),
                                 (("--scenes", "nowhere.txt"), "nowhere.txt")):
            done = batch(WORK / "x", *arguments, expect=2)
            self.assertEqual(len(done.stderr.strip().splitlines()), 1, done.stderr)
            self.assertIn(words, done.stderr)


def free_port():
    with socket.socket() as probe:
        probe.bind(("127.0.0.1", 0))
        return probe.getsockname()[1]


class Cluster:
    """munged, slurmctld and slurmd in a folder of their own, for one node on 127.0.0.1."""

    CONFIG = """
ClusterName=test
SlurmctldHost=localhost(127.0.0.1)
SlurmctldPort={controller_port}
SlurmdPort={node_port}
SlurmUser=root
SlurmdUser=root
AuthType=auth/munge
AuthInfo=socket={folder}/munge.socket
CredType=cred/munge
StateSaveLocation={folder}/state
SlurmdSpoolDir={folder}/spool
SlurmctldPidFile={folder}/slurmctld.pid
SlurmdPidFile={folder}/slurmd.pid
SlurmctldLogFile={folder}/slurmctld.log
SlurmdLogFile={folder}/slurmd.log
ProctrackType=proctrack/linuxproc
TaskPlugin=task/none
JobAcctGatherType=jobacct_gather/none
AccountingStorageType=accounting_storage/none
CommunicationParameters=NoInAddrAny,NoCtldInAddrAny
MpiDefault=none
ReturnToService=2
SchedulerParameters=batch_sched_delay=1,sched_interval=1
SelectType=select/cons_tres
SelectTypeParameters=CR_CPU
NodeName=localhost NodeAddr=127.0.0.1 CPUs={cpus} State=UNKNOWN
PartitionName=all Nodes=localhost Default=YES MaxTime=INFINITE State=UP
"""

    def __init__(self, folder):
        self.folder = folder
        self.daemons = []
        for name in ("state", "spool"):
            (folder / name).mkdir(parents=True)
        folder.chmod(0o755)
        config = folder / "slurm.conf"
        config.write_text(self.CONFIG.format(folder=folder, controller_port=free_port(),
                                             node_port=free_port(), cpus=os.cpu_count()),
                          encoding="utf-8")
        # Nothing in the configuration makes use of cgroups; the plugin of version 1 asks for none.
        (folder / "cgroup.conf").write_text("CgroupPlugin=cgroup/v1\n", encoding="utf-8")
        self.env = {**os.environ, "SLURM_CONF": str(config)}

    def start(self):
        key = self.folder / "munge.key"
        key.write_bytes(os.urandom(128))
        key.chmod(0o400)
        self.daemon("munged", "--foreground", "--force", f"--socket={self.folder}/munge.socket",
                    f"--key-file={key}", f"--pid-file={self.folder}/munged.pid",
                    f"--log-file={self.folder}/munged.log", f"--seed-file={self.folder}/munged.seed")
        self.wait(lambda: (self.folder / "munge.socket").exists(), "munged")
        self.daemon("slurmctld", "-D", "-i")
        self.daemon("slurmd", "-D", "-N", "localhost")
        self.wait(lambda: "idle" in self.sinfo(), "the node")

    def daemon(self, name, *arguments):
        with open(self.folder / f"{name}.out", "w", encoding="utf-8") as log:
            self.daemons.append(
                subprocess.Popen([shutil.which(name) or f"/usr/sbin/{name}", *arguments],
                                 env=self.env, stdout=log, stderr=log))

    def sinfo(self):
        done = subprocess.run(["sinfo", "--noheader", "--format=%T"], env=self.env, text=True,
                              capture_output=True, check=False)
        return done.stdout

    def wait(self, condition, what):
        for _ in range(300):
            if condition():
                return
            time.sleep(0.2)
        logs = "\n".join(path.read_text(errors="replace")[-2000:]
                         for path in self.folder.glob("*.out"))
        raise AssertionError(f"{what} did not come up\n{logs}")

    def stop(self):
        for process in reversed(self.daemons):
            process.terminate()
        for process in reversed(self.daemons):
            process.wait(timeout=60)


class Slurm(Batch):
    @classmethod
    def setUpClass(cls):
        cls.cluster = Cluster(WORK / "cluster")
        cls.addClassCleanup(cls.cluster.stop)
        cls.cluster.start()

    def test_slurm(self):
        out = WORK / "slurm"
        self.check_all(out, "--on", "slurm", env=self.cluster.env)
        self.assertEqual(len(list((out / "slurm").glob("track-*.log"))), 2)
        self.assertEqual(len(list((out / "slurm").glob("render-*.log"))), 4)
        self.check_resume(out, "--on", "slurm", env=self.cluster.env)

    def test_no_cluster_is_one_line(self):
        done = batch(WORK / "none", "--on", "slurm", "--sbatch=--partition=moon", expect=2,
                     env=self.cluster.env)
        self.assertEqual(len(done.stderr.strip().splitlines()), 1, done.stderr)
        self.assertIn("moon", done.stderr)


if __name__ == "__main__":
    unittest.main(argv=[sys.argv[0], *sys.argv[3:]])
