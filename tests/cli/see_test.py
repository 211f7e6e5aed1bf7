"""vismat see gives the same bytes with threads, with three ranks, and after kill -9; its bounds hold one another.

see_test.py VISMAT MPI (1 if it was built with it)
"""
import os
import signal
import subprocess
import sys
import tempfile
import time
from pathlib import Path

vismat, mpi = sys.argv[1], sys.argv[2] == "1"
environment = dict(os.environ, OMPI_ALLOW_RUN_AS_ROOT="1", OMPI_ALLOW_RUN_AS_ROOT_CONFIRM="1", ASAN_OPTIONS="detect_leaks=0")
folder = tempfile.TemporaryDirectory()
os.chdir(folder.name)


def run(*words, ranks=0):
    before = ["mpirun", "--oversubscribe", "-n", str(ranks)] if ranks else []
    done = subprocess.run([*before, vismat, *words], env=environment, capture_output=True, text=True, timeout=200)
    if done.returncode != 0:
        sys.exit(f"see_test.py: {words}: {done.stderr}")
    return done


def check(fact, *told):
    if not fact:
        sys.exit(f"see_test.py: line {sys._getframe(1).f_lineno}: " + " ".join(map(str, told)))


def see(name):
    return ["see", "city.scene.h5", "--cells", "grid:6,6,1.5", "--region", "20,20,1,80,80,2.5", "--rays", "500", "--patches", "20", "--objects",
            "-o", f"{name}.bsp.h5", "--seen", f"{name}.seen.bsp.h5"]


def same(name):
    check(not Path(f"{name}.bsp.h5.journal").exists(), name, "left a journal")
    for kind in ("", ".seen"):
        check(Path(f"{name}{kind}.bsp.h5").read_bytes() == Path(f"one{kind}.bsp.h5").read_bytes(), name, kind, "has other bytes")


run("city", "--size", "8", "-o", "city.scene.h5")
run(*see("one"), "--threads", "1")
run("verify", "one.bsp.h5", "one.seen.bsp.h5")
run(*see("three"), "--threads", "3")
same("three")
if mpi:
    run(*see("ranks"), "--threads", "1", ranks=3)
    same("ranks")

# Killed as soon as something is stored, again and again.
for attempt in range(4):
    process = subprocess.Popen([vismat, *see("killed"), "--threads", "1"], env=environment, stdout=subprocess.DEVNULL, stderr=subprocess.DEVNULL)
    journal = Path("killed.bsp.h5.journal")
    size = journal.stat().st_size if journal.exists() else 0
    while process.poll() is None and (not journal.exists() or journal.stat().st_size < size + 2000):
        time.sleep(0.005)
    process.send_signal(signal.SIGKILL)
    process.wait()
    check(not Path("killed.bsp.h5").exists() or not journal.exists(), "half written")
done = run(*see("killed"), ranks=2 if mpi else 0)
same("killed")
print("same bytes:", Path("one.bsp.h5").stat().st_size, "and", Path("one.seen.bsp.h5").stat().st_size)
