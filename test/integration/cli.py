"""The planecast executable as a user runs it, for the integration tests.

Each of them is called as: NAME_test.py PLANECAST WORK_FOLDER [unittest arguments]
"""

import pathlib
import shutil
import subprocess
import sys

PLANECAST = pathlib.Path(sys.argv[1]).resolve()
WORK = pathlib.Path(sys.argv[2]).resolve()
ROOT = pathlib.Path(__file__).resolve().parents[2]


def planecast(*arguments, expect=0):
    """Runs it in the project's root; any other exit status than the expected one is an error."""
    done = subprocess.run(
        [str(PLANECAST), *map(str, arguments)], cwd=ROOT, capture_output=True, text=True, timeout=900
    )
    if done.returncode != expect:
        raise AssertionError(
            f"planecast {' '.join(map(str, arguments))}: exit {done.returncode}, "
            f"expected {expect}\n{done.stdout}\n{done.stderr}"
        )
    return done


def empty_work_folder():
    shutil.rmtree(WORK, ignore_errors=True)
    WORK.mkdir(parents=True)
