"""Ends a running planecast by a signal at a moment of its work, for the integration tests."""

import os
import pty
import re
import signal
import subprocess

from cli import PLANECAST, ROOT

# By a kill at any moment these may differ: they hold times, or what the command line was.
WITH_TIMES = {"times.csv", "timings.json", "report.html"}


def start(*arguments):
    """The process, and the end of the terminal on which it draws a bar for every frame."""
    main, side = pty.openpty()
    process = subprocess.Popen([str(PLANECAST), *map(str, arguments)], cwd=ROOT, stderr=side,
                               stdout=subprocess.PIPE, stdin=subprocess.DEVNULL)
    os.close(side)
    return process, main


def read_until(terminal, pattern):
    """What was printed up to the pattern, or to the end."""
    text = ""
    try:
        while not re.search(pattern, text):
            block = os.read(terminal, 4096)
            if not block:
                break
            text += block.decode(errors="replace")
    except OSError:  # the other end was closed
        pass
    return text


def lines_of(text):
    """The lines that are no bar."""
    lines = [line.split("\033[K")[-1].strip() for line in text.replace("\r\n", "\n").split("\n")]
    return [line for line in lines if line]


def stop(moment, stopper, *arguments):
    """Runs the command and sends the signal when `moment` (a pattern of its progress) is shown; its exit
    status as the system gives it (-9 for a kill), the last line and whether the moment came."""
    process, terminal = start(*arguments)
    try:
        text = read_until(terminal, moment)
        came = re.search(moment, text) is not None and process.poll() is None
        process.send_signal(stopper)
        text += read_until(terminal, r"(?!)")
        status = process.wait(timeout=120)
    finally:
        process.kill()
        process.wait()
        process.stdout.close()
        os.close(terminal)
    return status, (lines_of(text) or [""])[-1], came


def kill(moment, *arguments):
    status, _, came = stop(moment, signal.SIGKILL, *arguments)
    return status == -signal.SIGKILL and came


def differing(folder, other):
    """Files of which the folders do not hold the same bytes, but for those with times."""
    names = {str(path.relative_to(base)) for base in (folder, other) for path in base.rglob("*")
             if path.is_file()} - WITH_TIMES
    return sorted(name for name in names
                  if not (folder / name).is_file() or not (other / name).is_file()
                  or (folder / name).read_bytes() != (other / name).read_bytes())
