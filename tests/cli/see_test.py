"""Every producer of 'vismat see' gives the same bytes with threads, with three ranks, and after kill -9; bounds hold one another.

see_test.py VISMAT MPI (1 if it was built with it)
"""
import os
import re
import resource
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


# What makes a producer quick, and what it writes beside -o; a producer that is not here runs as it is by default.
SMALL = ["small.scene.h5"]
BOXES = ["city.scene.h5", "--cells", "grid:6,6,1.5", "--region", "20,20,1,56,56,2.5", "--objects"]
SETTINGS = {
    "shadow": [*SMALL, "--patches", "20"],
    "sampled": [*SMALL, "--rays", "500"],
    "sandwich": [*BOXES, "--rays", "500", "--patches", "20", "--seen", "{}.seen.bsp.h5"],
    "climbing": [*SMALL, "--viewpoints", "4"],
}


def see(producer, name):
    words = SETTINGS.get(producer, SMALL)
    return ["see", "--producer", producer, "-o", f"{name}.bsp.h5", *(word.format(name) for word in words)]


def check_same(name, producer):
    """As the run that is called after the producer alone."""
    check(not Path(f"{name}.bsp.h5.journal").exists(), name, "left a journal")
    for kind in ("", ".seen"):
        expected = Path(f"{producer}{kind}.bsp.h5")
        check(not expected.exists() or Path(f"{name}{kind}.bsp.h5").read_bytes() == expected.read_bytes(), name, kind, "has other bytes")


def kill_once_it_grows(words, journal):
    process = subprocess.Popen([vismat, *words], env=environment, stdout=subprocess.DEVNULL, stderr=subprocess.DEVNULL)
    size = journal.stat().st_size if journal.exists() else 0
    while process.poll() is None and (not journal.exists() or journal.stat().st_size < size + 1000):
        time.sleep(0.002)
    process.send_signal(signal.SIGKILL)
    process.wait()


run("city", "--size", "8", "-o", "city.scene.h5")
run("city", "--size", "4", "-o", "small.scene.h5")
producers = re.search(r"--producer\s.*?\{([^}]*)\}", run("see", "--help").stdout, re.S).group(1).split(",")
check(set(SETTINGS) <= set(producers), producers)
for producer in producers:
    run(*see(producer, producer), "--threads", "1")
    three = producer + ".three"
    run(*see(producer, three), "--threads", "3")
    check_same(three, producer)
    if mpi:
        ranks = producer + ".ranks"
        run(*see(producer, ranks), "--threads", "1", ranks=3)
        check_same(ranks, producer)

    # The disk is full, which a limit on the size of files plays, once some pieces are stored; ranks go on.
    ended = producer + ".ended"
    journal = Path(f"{ended}.bsp.h5.journal")
    for limit in 2000, 8000, 32000:
        full = subprocess.run([vismat, *see(producer, ended)], capture_output=True, text=True, timeout=200,
                              preexec_fn=lambda: resource.setrlimit(resource.RLIMIT_FSIZE, (limit, limit)))
        check(full.returncode == 1 and "cannot store more" in full.stderr, producer, full.stderr)
        if journal.stat().st_size > 1000:  # more than its head
            break
    check("going on after" in run(*see(producer, ended), ranks=2 if mpi else 0).stderr, producer, "began again")
    check_same(ended, producer)

    killed = producer + ".killed"
    journal = Path(f"{killed}.bsp.h5.journal")
    for attempt in range(3):
        kill_once_it_grows([*see(producer, killed), "--threads", "1"], journal)
        for kind in ("", ".seen"):
            output = Path(f"{killed}{kind}.bsp.h5")
            check(not output.exists() or output.read_bytes() == Path(f"{producer}{kind}.bsp.h5").read_bytes(), "half written")
    run(*see(producer, killed))
    check_same(killed, producer)
    print(producer, "gives the same bytes:", Path(f"{producer}.bsp.h5").stat().st_size)
run("verify", "sandwich.bsp.h5", "sandwich.seen.bsp.h5")

# What a producer does not take is refused before anything is done, in one line.
for words, told in ((["--rays", "5"], "--rays: the producer shadow does not take it; these do: sampled, sandwich"),
                    (["--seen", "seen.bsp.h5"], "--seen: the producer shadow proves nothing seen"),
                    (["--effort", "3"], "effort 3 is none of 0, 1 and 2")):
    refused = subprocess.run([vismat, *see("shadow", "refused"), *words], capture_output=True, text=True, timeout=200)
    check(refused.returncode == 1 and refused.stderr.startswith(f"vismat: {told}") and refused.stderr.count("\n") == 1, refused.stderr)
