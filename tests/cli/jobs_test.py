"""A JobRunner's output has the same bytes for any number of threads and ranks, and after any end of earlier runs.

jobs_test.py JOBS_TOY MPI (1 if it was built with it)
"""
import os
import random
import resource
import signal
import subprocess
import sys
import tempfile
import time
from pathlib import Path

toy, mpi = sys.argv[1], sys.argv[2] == "1"
# Open MPI's own memory is never given back whole, hence no search for leaks in its processes.
environment = dict(os.environ, OMPI_ALLOW_RUN_AS_ROOT="1", OMPI_ALLOW_RUN_AS_ROOT_CONFIRM="1", ASAN_OPTIONS="detect_leaks=0")
folder = tempfile.TemporaryDirectory()
os.chdir(folder.name)
out = Path("out")
random.seed(6)


def command(ranks, *words):
    """Without mpirun for no ranks."""
    before = ["mpirun", "--oversubscribe", "-n", str(ranks)] if ranks else []
    return before + [toy, *map(str, words)]


def run(ranks, *words, **more):
    return subprocess.run(command(ranks, *words), env=environment, capture_output=True, text=True, timeout=100, **more)


def check(fact, *told):
    if not fact:
        sys.exit(f"jobs_test.py: line {sys._getframe(1).f_lineno}: " + " ".join(map(str, told)))


def output_of(finished):
    check(finished.returncode == 0, finished.stderr)
    check(not Path("out.journal").exists(), "a journal is left")
    content = out.read_bytes()
    out.unlink()
    return content


expected = output_of(run(0, "out", 1, 0))
for threads in 2, 5:
    check(output_of(run(0, "out", threads, 1)) == expected, threads, "threads")
for ranks, threads in ((1, 2), (3, 1), (3, 2), (2, 0)) if mpi else ():
    check(output_of(run(ranks, "out", threads, 1)) == expected, ranks, "ranks")

# A piece that fails: told once, and the next run goes on.
for ranks in (0, 3) if mpi else (0,):
    failed = run(ranks, "out", 2, 1, 17)
    check(failed.returncode == 1, failed.returncode, failed.stderr)
    check(failed.stderr.count("jobs_toy: piece 17 is broken") == 1 == failed.stderr.count("jobs_toy:"), failed.stderr)
    check(not out.exists(), "written in spite of a failure")
    again = run(0, "out", 1, 0)
    check("going on after" in again.stderr, again.stderr)
    check(output_of(again) == expected, "after a failure")


def stat_of(pid):
    """State, parent, ..."""
    return Path(f"/proc/{pid}/stat").read_text().rsplit(")", 1)[1].split()


def ranks_of(process):
    ranks = []
    for pid in filter(str.isdigit, os.listdir("/proc")):
        try:
            if int(stat_of(pid)[1]) == process.pid:
                ranks.append(int(pid))
        except OSError:  # gone meanwhile
            pass
    return ranks


def runs(pid):
    try:
        return stat_of(pid)[0] != "Z"
    except OSError:
        return False


# kill -9 at any moment, of any process; with another number of ranks, or none, the next run goes on.
for attempt in range(6):
    ranks = random.choice([0, 2, 3]) if mpi else 0
    killed = subprocess.Popen(command(ranks, "out", 1, 20), env=environment, stdout=subprocess.DEVNULL, stderr=subprocess.DEVNULL)
    time.sleep(random.uniform(0.05, 1.5))
    ours = ranks_of(killed)
    victim = random.choice([killed.pid, *ours]) if killed.poll() is None else None
    if victim:
        try:
            os.kill(victim, signal.SIGKILL)
        except ProcessLookupError:
            pass  # it was done
    killed.wait(timeout=60)
    for patience in range(100):  # ranks without their mpirun end too
        left = [pid for pid in ours if runs(pid)]
        if not left:
            break
        time.sleep(0.1)
    check(not left, "ranks go on after the kill of process", victim, "of", killed.pid, ours)
    if out.exists():  # it was quicker than the kill
        check(out.read_bytes() == expected, "a run that was hardly killed")
        out.unlink()
    if attempt % 2:
        check(output_of(run(random.choice([0, 3]) if mpi else 0, "out", 2, 0)) == expected, "after a kill")

# A full disk, which a limit on the size of files plays: one line, and the next run goes on.
if Path("out.journal").exists():
    Path("out.journal").unlink()
for ranks in (0, 3) if mpi else (0,):
    limit = 5000000  # in the second stage
    full = run(ranks, "out", 1, 0, restore_signals=False,
               preexec_fn=lambda: resource.setrlimit(resource.RLIMIT_FSIZE, (limit, limit)))
    check(full.returncode == 1, full.returncode, full.stderr)
    check(full.stderr.count("jobs_toy: out.journal: cannot store more") == 1 == full.stderr.count("jobs_toy:"), full.stderr)
    again = run(ranks, "out", 2, 0)
    check("going on after" in again.stderr, again.stderr)
    check(output_of(again) == expected, "after a full disk")

# What is wrong before any piece is told once as well.
Path("out.journal").write_bytes(b"something else that stands there")
refused = run(3 if mpi else 0, "out", 1, 0)
check(refused.returncode == 1 and refused.stderr.count("jobs_toy: out.journal: not a journal") == 1, refused.stderr)
check(Path("out.journal").read_bytes() == b"something else that stands there", "a stranger's file is changed")
