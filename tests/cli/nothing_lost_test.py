"""Nothing is lost: wrong numbers and output names are refused before any work, and what cannot be written is told.

nothing_lost_test.py VISMAT BENCH [TEST ...] (BENCH is empty where it is not built; without TEST all of them)
"""
import itertools
import os
import re
import resource
import signal
import stat
import subprocess
import sys
import tempfile
import time
from pathlib import Path

vismat, bench = sys.argv[1:3]
programs = [program for program in (vismat, bench) if program]
environment = dict(os.environ, ASAN_OPTIONS="detect_leaks=0")
folder = tempfile.TemporaryDirectory()
os.chdir(folder.name)


def run(*words, program=vismat, **how):
    how = {"stdin": subprocess.DEVNULL, "stdout": subprocess.PIPE, **how}
    return subprocess.run([program, *map(str, words)], env=environment, stderr=subprocess.PIPE, text=True, timeout=100, **how)


def check(fact, *told):
    if not fact:
        sys.exit(f"nothing_lost_test.py: line {sys._getframe(1).f_lineno}: " + " ".join(map(str, told)))


def succeed(*words, **how):
    done = run(*words, **how)
    check(done.returncode == 0, words, done.returncode, done.stderr)
    return done


def files():
    return {str(path): path.read_bytes() for path in Path(".").rglob("*") if path.is_file()}


def refuse(why, *words, program=vismat, **how):
    """Exit 1 after one line that says why; no file is made, changed or removed."""
    before = files()
    done = run(*words, program=program, **how)
    told = (words, done.returncode, done.stderr)
    check(done.returncode == 1 and done.stderr.count("\n") == 1 and why in done.stderr, "not refused by", why, *told)
    check(files() == before, "files differ", *told)
    return done.stderr


def verbs(program):
    """Each verb with its options and arguments: name, type as help shows it, help."""
    text = succeed("--help", program=program).stdout
    # Groups of verbs come last, each verb indented by two.
    names = re.findall(r"^  ([a-z][a-z0-9-]*) ", text[text.index("\nOptions:"):], re.M)
    check(len(names) > 15, names)
    result = {}
    for name in names:
        text = succeed(name, "--help", program=program).stdout
        entries = re.findall(r"^  ((?:-\w,)?--[\w-]+|-\w,[^ ]+|[A-Z]+) ((?:TEXT|UINT|INT|FLOAT|FILE|FOLDER|A,B)[^\n]*(?:\n {20,}[^\n]*)*)", text, re.M)
        result[name] = [(option.split(",")[-1], kind.split()[0].split(":")[0], kind) for option, kind in entries]
    return result


MATRIX = "%%MatrixMarket matrix coordinate pattern general\n4 5 6\n1 1\n1 2\n2 2\n3 3\n3 5\n4 1\n"
Path("in.mtx").write_text(MATRIX)
succeed("convert", "in.mtx", "-o", "in.bsp.h5")
succeed("encode", "in.mtx", "-o", "in.vmat")
succeed("city", "--size", 4, "-o", "in.scene.h5")
Path("in.path").write_text("0 0 0 0 0 0 0 1\n")
INPUTS = {"SCENE": "in.scene.h5", "INPUT": "in.scene.h5", "MATRIX": "in.mtx", "IN": "in.mtx", "FILE": "in.vmat",
          "ORIGINAL": "in.mtx", "--witness": "in.scene.h5", "--boxes": "in.mtx", "LEVEL": "in.scene.h5", "PLACE": "in.mtx", "BAKE": "in.bake",
          "PATH": "in.path"}
REQUIRED = {"MODEL": "city", "ROW": "1", "NODE": "0"}


def arguments(options, without=()):
    """What a verb needs to run, without some of its options."""
    words = []
    for option, kind, text in options:
        if option in without or not (option.isupper() or "REQUIRED" in text):
            continue
        if option in ("ORIGINAL",):
            continue
        if option == "--output":
            words += ["-o", "out.txt"]  # any name; numbers are looked at before files
        else:
            words.append(REQUIRED.get(option) or INPUTS[option])
    return words


def numbers():
    """Every number of every verb is looked at: each option refuses what CLI11 alone would take, and one of the other texts in turn,
    so that some options of each type refuse each of them."""
    telling = {"UINT": ["-1", "0x10"], "INT": ["-1", "0x10"], "FLOAT": ["-1", "nan"]}
    other = ["inf", "-inf", "1e400", "", "5x", "NaN", "infinity", "1e-400", "+-1", " 1", "1 "]
    turns = {"UINT": itertools.cycle([*other, "nan", "18446744073709551616", "1.5", "1e3"]), "FLOAT": itertools.cycle([*other, "0x10"])}
    turns["INT"] = turns["UINT"]
    for program in programs:
        seen = 0
        for verb, options in verbs(program).items():
            for option, kind, text in options:
                if kind not in ("UINT", "INT", "FLOAT"):
                    continue
                seen += 1
                for value in (*telling[kind], next(turns[kind])):
                    words = arguments(options, without=[option])
                    given = [value] if option.isupper() else [option, value]
                    refuse("", verb, *words, *given, program=program)
        check(seen > 15, program, seen)
    for value in ("0,.05,nan", "nan,0", "0,-1", "0,5x") if bench else ():
        refuse("--lost", "lossy-tables", "--lost", value, "in.mtx", program=bench)
    check(run("row", "in.vmat", "03").stderr.startswith("row 3:"), "a leading zero")
    refuse("no row 10", "row", "in.vmat", "010")
    refuse("--memory", "order", "in.mtx", "--columns", "best", "-o", "out.mtx", "--memory", "17179869184G")
    refuse("--memory", "order", "in.mtx", "--columns", "best", "-o", "out.mtx", "--memory", "12X")
    for size in ("010K", "1M", "1MB", "1mib", "70000"):
        succeed("order", "in.mtx", "--columns", "best", "-o", "out.mtx", "--memory", size)
    os.remove("out.mtx")
    succeed("city", "--size", 4, "--seed", 2**64 - 1, "-o", "out.scene.h5")
    os.remove("out.scene.h5")


def names():
    """Every verb names its files as such, and none of them writes over what it reads or what it wrote."""
    for program in programs:
        for verb, options in verbs(program).items():
            for option, kind, text in options:
                told = " ".join(text.split())
                says = re.search(r"to write|Also write|[Mm]atrix file|scene file \(|\.vmat file|File (for|with)|Folder for|to this file", told)
                if text.startswith("TEXT ") and option != "--cells":
                    check(not says, verb, option, "is a file, but not given as one:", told)
    ends = {"encode": ".vmat", "city": ".scene.h5", "dense-city": ".scene.h5", "plant": ".scene.h5", "cells": ".scene.h5", "scene": ".scene.h5",
            "triangles": ".csv", "path": ".txt"}
    for verb, options in verbs(vismat).items():
        outputs = [option for option, kind, text in options if kind == "FILE" and ("rite" in text)]
        inputs = [option for option, kind, text in options if kind == "FILE" and option not in outputs]
        needed = arguments(options, without=["--output"])
        for option in outputs:
            end = ".scene.h5" if option == "--scene" else ".txt" if option in ("--csv", "--json", "--log", "--summary") else ends.get(verb, ".mtx")
            others = [] if option == "--output" or verb in ("compare", "walk") else ["-o", "other" + ends.get(verb, ".mtx")]
            words = [verb, *needed, *others, option]
            if end not in (".txt", ".csv"):
                refuse("is written as", *words, "out.txt")
                refuse("is written as", *words, "out")
            else:
                refuse("is the name of a matrix or scene", *words, "out.bsp.h5")
            refuse("No such file", *words, "nowhere/out" + end)
            refuse("names no file", *words, "")
            os.mkdir("folder" + end)
            refuse("Is a directory", *words, "folder" + end)
            os.rmdir("folder" + end)
            for given in inputs:
                if not given.isupper() or given == "ORIGINAL":
                    continue
                # The input by another name, with the ending that the output needs.
                source = INPUTS[given]
                for link in (os.link, os.symlink):
                    link(source, "same" + end)
                    refuse("is the input", *words, "same" + end)
                    os.remove("same" + end)
                refuse("is the input", *words, "./" + source)
                refuse("is the input", *words, os.path.abspath(source))
    os.symlink("later.mtx", "link.mtx")
    see = ["see", "in.scene.h5", "--threads", 1, "--effort", 0]
    for other in ("one.mtx", "./one.mtx", os.path.abspath("one.mtx")):
        refuse("-o writes the same file", *see, "-o", "one.mtx", "--seen", other)
    refuse("writes the same file", *see, "-o", "later.mtx", "--seen", "link.mtx")
    os.remove("link.mtx")
    refuse("is the input", "scene", "in.scene.h5", "-o", "in.scene.h5")
    if os.geteuid() != 0:
        os.mkdir("closed", 0o500)
        refuse("Permission denied", "convert", "in.mtx", "-o", "closed/out.mtx")
        os.rmdir("closed")


def places():
    """Devices, pipes and links stay what they are; so do rights."""
    for words in (["encode", "in.mtx", "-o", "/dev/null"], ["order", "in.mtx", "--columns", "best", "-o", "out.bsp.h5", "--json", "/dev/null"]):
        succeed(*words)
        check(stat.S_ISCHR(os.stat("/dev/null").st_mode), words)
    os.mkfifo("pipe.vmat")
    os.mkfifo("pipe.mtx")
    os.mkfifo("pipe.bsp.h5")
    for name, words in (("pipe.vmat", ["encode", "in.mtx"]), ("pipe.mtx", ["convert", "in.bsp.h5"])):
        reader = subprocess.Popen(["cat", name], stdout=subprocess.PIPE)
        succeed(*words, "-o", name)
        succeed(*words, "-o", "file" + name[4:])
        check(reader.communicate(timeout=50)[0] == Path("file" + name[4:]).read_bytes(), name)
        check(stat.S_ISFIFO(os.stat(name).st_mode), name)
        os.remove("file" + name[4:])
    refuse("is no regular file", "convert", "in.mtx", "-o", "pipe.bsp.h5")
    refuse("is no regular file", "city", "--size", 4, "-o", "/dev/null")
    refuse("is no regular file", "order", "pipe.mtx", "--columns", "best", "--memory", "1G", "-o", "out2.mtx")
    for name in ("pipe.vmat", "pipe.mtx", "pipe.bsp.h5"):
        os.remove(name)
    # A matrix that comes once is measured in both orders.
    once = subprocess.run(["sh", "-c", f"cat in.mtx | {vismat} compare /dev/stdin --orders natural,best --codecs delimiter --seconds 0"], env=environment,
                          capture_output=True, text=True)
    check(once.returncode == 0 and once.stdout.count("delimiter") == 2, once)
    compare = ["compare", "in.mtx", "--codecs", "delimiter", "--seconds", 0, "--csv", "/dev/stdout"]
    with open("both", "w") as both:
        succeed(*compare, stdout=both)
    for text in (Path("both").read_text(), succeed(*compare).stdout):  # into a file and into a pipe
        check("M ids/s" in text and text.index("M ids/s") < text.index("matrix,"), text)

    for before, after in (("target.mtx", "target.mtx"), ("target.bsp.h5", "target.bsp.h5")):
        for exists in (False, True):
            link = "link" + before[6:]
            os.symlink(before, link)
            succeed("convert", "in.mtx", "-o", link)
            check(os.path.islink(link) and not os.path.islink(after), link)
            check("6" in succeed("info", after).stdout, after)
            os.remove(link)
        os.chmod(after, 0o640)
        if os.geteuid() == 0:
            os.chown(after, 12, 34)
            os.chmod(after, 0o640)
        was = os.stat(after)
        succeed("convert", "in.mtx", "-o", after)
        now = os.stat(after)
        check((was.st_mode, was.st_uid, was.st_gid) == (now.st_mode, now.st_uid, now.st_gid) and was.st_ino != now.st_ino, after)


def standard_output():
    with open("/dev/full", "w") as full:
        for program, words in ((vismat, ["row", "in.vmat", 0]), (vismat, ["info", "in.mtx"]), (vismat, ["verify", "in.mtx", "in.mtx"]), (vismat, ["--help"]),
                               (vismat, ["--version"]), (vismat, ["see", "--help"]), (bench, ["--help"]), (bench, ["speed", "--help"])):
            if not program:
                continue
            done = run(*words, program=program, stdout=full)
            told = [line for line in done.stderr.splitlines() if "standard output: No space left on device" in line]
            check(done.returncode == 1 and len(told) == 1, words, done.returncode, done.stderr)
    # More than a buffer, so that the error comes long before the end.
    Path("wide.mtx").write_text("%%MatrixMarket matrix coordinate pattern general\n1 20000 20000\n" + "".join(f"1 {c}\n" for c in range(1, 20001)))
    succeed("encode", "wide.mtx", "-o", "wide.vmat")
    with open("/dev/full", "w") as full:
        done = run("row", "wide.vmat", 0, stdout=full)
        check(done.returncode == 1 and "standard output: No space left on device" in done.stderr, done)
    # Nobody reads the lines, but the table is there.
    reader = subprocess.Popen([vismat, "compare", "in.mtx", "wide.mtx", "--codecs", "delimiter,gzip", "--seconds", ".1", "--csv", "lines.csv"], stdout=subprocess.PIPE,
                              stderr=subprocess.PIPE, env=environment)
    reader.stdout.close()
    error = reader.stderr.read()
    check(reader.wait(timeout=100) == 128 + signal.SIGPIPE and error == b"", "SIGPIPE", reader.returncode, error)
    check(Path("lines.csv").read_text().count("\n") == 5, "the table is not whole")
    # A side file that fails at the last moment costs no result.
    done = run("order", "in.mtx", "--columns", "best", "--json", "/dev/full", "-o", "kept.mtx")
    check(done.returncode == 1 and "/dev/full" in done.stderr and Path("kept.mtx").exists(), done)


def closed_descriptors():
    for closed in itertools.chain.from_iterable(itertools.combinations((0, 1, 2), n) for n in (1, 2, 3)):
        close = " ".join(f"{descriptor}>&-" for descriptor in closed)
        for words in ("info in.bsp.h5", "convert in.bsp.h5 -o closed.bsp.h5", "compare in.bsp.h5 --codecs gzip --seconds 0"):
            done = subprocess.run(["sh", "-c", f"{vismat} {words} {close}"], env=environment, capture_output=True, text=True, stdin=subprocess.DEVNULL)
            check(done.returncode == 0, words, close, done.returncode, done.stderr)
        check(Path("closed.bsp.h5").read_bytes() == Path("in.bsp.h5").read_bytes(), close)
        os.remove("closed.bsp.h5")


def full_disk():
    """A limit on the size of files is the full disk that needs no rights."""
    def limit(size):
        return lambda: resource.setrlimit(resource.RLIMIT_FSIZE, (size, size))
    succeed("generate", "power-plant", "--scale", "0.002", "-o", "large.bsp.h5")
    sizes = list(range(0, 8192, 512)) + [16384]
    for size in sizes:
        for words in (["city", "--size", 8, "-o", "full.scene.h5"], ["convert", "large.bsp.h5", "-o", "full.bsp.h5"], ["encode", "large.bsp.h5", "-o", "full.vmat"],
                      ["convert", "large.bsp.h5", "-o", "full.mtx"]):
            if words[0] == "encode" and size > 1000:
                continue
            refuse(words[-1] + ": ", *words, preexec_fn=limit(size))


def wait_for(fact, what):
    end = time.monotonic() + 60
    while not fact():
        check(time.monotonic() < end, what, "does not come")
        time.sleep(.01)


def signals():
    succeed("city", "--size", 32, "-o", "city.scene.h5")
    for number in ("INT", "TERM", "HUP", "QUIT", "PIPE", "ALRM", "USR1", "USR2", "XCPU"):
        number = getattr(signal, "SIG" + number)
        process = subprocess.Popen([vismat, "see", "city.scene.h5", "--producer", "shadow", "--effort", "0", "--threads", "1", "-o", "killed.bsp.h5"],
                                   stdout=subprocess.DEVNULL, stderr=subprocess.DEVNULL, env=environment)
        wait_for(lambda: Path("killed.bsp.h5.journal").exists() or process.poll() is not None, "the journal")
        process.send_signal(number)
        check(process.wait(timeout=60) == 128 + number, number, process.returncode)
        check(not [name for name in os.listdir() if "partial" in name], os.listdir())
        Path("killed.bsp.h5.journal").unlink(missing_ok=True)


def two_writers():
    """Whoever is last, the file is whole, also if both have the same process number."""
    succeed("generate", "power-plant", "--scale", "0.004", "--seed", 1, "-o", "a.mtx")
    succeed("generate", "power-plant", "--scale", "0.004", "--seed", 5, "-o", "b.mtx")
    for end in (".mtx", ".bsp.h5"):
        whole = set()
        for name in ("a", "b"):
            succeed("convert", name + ".mtx", "-o", "whole" + end)
            whole.add(Path("whole" + end).read_bytes())
        for _ in range(6):
            both = [subprocess.Popen([vismat, "convert", name + ".mtx", "-o", "one" + end], env=environment, stderr=subprocess.PIPE) for name in "ab"]
            for process in both:
                check(process.wait(timeout=60) == 0, process.stderr.read())
            check(Path("one" + end).read_bytes() in whole, "torn")


def journals():
    see = ["see", "in.scene.h5", "--producer", "shadow", "--threads", 1, "-o", "seen.mtx"]
    cells = ["--cells", "grid:20", "--region=0,0,1,40,40,2"]
    for wrong in ([*cells, "--resolution", 0], ["--cells", "grid:0"], ["--cells", "grid:nan"], [*cells, "--eyes", "900"]):
        refuse("", *see, *wrong)
    succeed(*see, *cells)
    check(not Path("seen.mtx.journal").exists())

    process = subprocess.Popen([vismat, "see", "city.scene.h5", "--producer", "shadow", "--effort", "0", "--threads", "1", "-o", "long.bsp.h5"],
                               stdout=subprocess.DEVNULL, stderr=subprocess.DEVNULL, env=environment)
    wait_for(lambda: Path("long.bsp.h5.journal").exists() and os.path.getsize("long.bsp.h5.journal") > 100_000, "work")
    process.kill()
    process.wait()
    why = refuse("finished pieces of other work", "see", "city.scene.h5", "--producer", "shadow", "--effort", "1", "--threads", "1", "-o", "long.bsp.h5")
    check("remove the file" in why and "repeat the old command" in why and len(why) < 500, why)
    os.remove("long.bsp.h5.journal")


def open_files(process):
    names = []
    for entry in Path(f"/proc/{process.pid}/fd").glob("*"):
        try:
            names.append(os.readlink(entry))
        except FileNotFoundError:
            pass
    return names


def changed_input():
    succeed("generate", "power-plant", "--scale", "0.0078125", "-o", "first.bsp.h5")
    succeed("generate", "power-plant", "--scale", "0.0078125", "--seed", 2, "-o", "same_shape.bsp.h5")
    succeed("generate", "power-plant", "--scale", "0.002", "-o", "smaller.bsp.h5")
    succeed("generate", "power-plant", "--scale", "0.01", "-o", "larger.bsp.h5")
    for other in ("same_shape.bsp.h5", "smaller.bsp.h5", "larger.bsp.h5", None):
        Path("changing.bsp.h5").write_bytes(Path("first.bsp.h5").read_bytes())
        process = subprocess.Popen([vismat, "order", "changing.bsp.h5", "--columns", "best", "--seconds", "1", "--bound", "none", "--memory", "6500000", "-o",
                                    "ordered.bsp.h5"], stdout=subprocess.PIPE, stderr=subprocess.PIPE, text=True, env=environment)
        wait_for(lambda: any("vismat-scratch" in name for name in open_files(process)), "the file of the transposed matrix")
        if other:
            os.link(other, "moved")
            os.rename("moved", "changing.bsp.h5")
        else:
            os.remove("changing.bsp.h5")
        error = process.communicate(timeout=60)[1]
        check(process.returncode == 1 and "changing.bsp.h5: changed while its columns were ordered" in error, other, process.returncode, error)
        check(not Path("ordered.bsp.h5").exists(), other)


for test in (numbers, names, places, standard_output, closed_descriptors, full_disk, signals, two_writers, journals, changed_input):
    if len(sys.argv) > 3 and test.__name__ not in sys.argv[3:]:
        continue
    test()
    print(test.__name__, flush=True)
