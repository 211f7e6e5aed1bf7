#!/usr/bin/env python3
"""Runs two builds of vismat side by side and compares what they write: for changes that must not change a result.

    same_results.py BEFORE AFTER LEVEL [--folder FOLDER] [--sets artificial-1,level-cells]

BEFORE and AFTER are vismat programs, LEVEL is FILE.pk3:maps/NAME.bsp. Both make the artificial sets and the level's matrices, order and
bound them, build trees, merge, make differences and undo them, encode with every codec, decode, and read rows and nodes. Matrices
(.bsp.h5) are compared byte for byte, or, where one holds more than the other, array by array; of .vmat files the payloads, whatever the
version of their containers, and what is decoded from them, before's files by either program. Printed runs and bounds are compared without
their times. Prints a line for each difference, and how much was compared; exits 1 if anything differs that both have.
"""
import argparse
import pathlib
import re
import struct
import subprocess
import sys
import tempfile

import h5py

ORDERS = ("lexicographic", "greedy", "bisection", "random", "sampled-tour", "best")
ARTIFICIAL = {"artificial-1": 32, "artificial-2": 64}  # blocks of the city, as ./reproduce has them


class Comparison:
    def __init__(self, before, after, folder):
        self.programs, self.folder = (before, after), folder
        self.compared, self.different, self.extended = {}, [], []

    def run(self, *arguments, output=None):
        """Both programs with the same arguments; '{}' in one is the program's own folder. Compares exit codes and, if asked, output."""
        said = []
        for side, program in zip(("before", "after"), self.programs):
            done = subprocess.run([program, *(str(a).replace("{}", str(self.folder / side)) for a in arguments)],
                                  capture_output=True, text=True)
            said.append((done.returncode, output(done.stdout) if output else None))
            if done.returncode and side == "after" and said[0][0] == 0:
                self.differ(" ".join(map(str, arguments)), done.stderr.strip())
        self.note("exit codes", said[0] == said[1], " ".join(map(str, arguments)))
        return said[1][0] == 0 and said[0][0] == 0

    def note(self, kind, same, what):
        self.compared[kind] = self.compared.get(kind, 0) + 1
        if not same:
            self.differ(kind, what)

    def differ(self, kind, what):
        self.different.append(f"{kind}: {what}")
        print(f"DIFFERENT {kind}: {what}", flush=True)

    def files(self, name):
        return [self.folder / side / name for side in ("before", "after")]

    def matrix(self, name):
        """Byte for byte; else array by array, where the new one may have more."""
        before, after = self.files(name)
        if before.read_bytes() == after.read_bytes():
            return self.note("matrices, bytes", True, name)
        contents = [h5_contents(file) for file in (before, after)]
        same = all(contents[1].get(key) == value for key, value in contents[0].items())
        self.note("matrices, arrays", same, name)
        if same:
            self.extended.append(f"{name}: also {', '.join(sorted(set(contents[1]) - set(contents[0])))}")

    def payload(self, name):
        self.note("payloads", vmat_payload(self.files(name)[0]) == vmat_payload(self.files(name)[1]), name)


def h5_contents(file):
    contents = {}
    with h5py.File(file) as source:
        contents.update({f"attribute {key}": str(value) for key, value in source.attrs.items()})

        def visit(name, item):
            contents.update({f"{name} attribute {key}": str(value) for key, value in item.attrs.items()})
            if isinstance(item, h5py.Dataset):
                contents[name] = (str(item.dtype), item.shape, item[...].tobytes())

        source.visititems(visit)
    return contents


def vmat_payload(file):
    data = file.read_bytes()
    version, = struct.unpack_from("<I", data, 8)
    if version == 3:
        size, = struct.unpack_from("<Q", data, 60 + 8 * 9)
        return data[len(data) - size:]
    count, = struct.unpack_from("<I", data, 60)
    at = len(data)
    for number, size in reversed([struct.unpack_from("<IQ", data, 64 + 12 * i) for i in range(count)]):
        at -= size
        if number == 16:
            return data[at:at + size]
    return b""


def without_times(text):
    return re.sub(r"; [0-9.]+ s$", "", text, flags=re.M)


def codecs_of(program):
    text = subprocess.run([program, "encode", "--help"], capture_output=True, text=True).stdout
    return re.sub(r"\s+", " ", re.search(r"One of (.*?)\n +--", text, re.S).group(1)).strip().split(", ")


def compare_matrix(c, name, codecs, all_steps):
    """What is made of NAME.bsp.h5, which both programs have; without all_steps the matrix alone, by every codec."""
    c.matrix(f"{name}.bsp.h5")
    source = f"{{}}/{name}.bsp.h5"
    for order in ORDERS if all_steps else ():
        if c.run("order", source, "--columns", order, "-o", f"{{}}/{name}.{order}.bsp.h5", "--bound", "quick" if order == "best" else "none",
                 output=without_times):
            c.matrix(f"{name}.{order}.bsp.h5")
    made = [name]
    steps = {"rows": ("order", source, "--rows", "best", "--bound", "none"), "tree": ("tree", source, "--side", "rows", "--by", "sets"),
             "merged": ("merge", source, "--side", "both", "--lost", ".02"), "deltas": ("deltas", source)}
    for step, arguments in steps.items() if all_steps else ():
        if c.run(*arguments, "-o", f"{{}}/{name}.{step}.bsp.h5"):
            c.matrix(f"{name}.{step}.bsp.h5")
            made.append(f"{name}.{step}")
    if f"{name}.deltas" in made and c.run("deltas", "--undo", f"{{}}/{name}.deltas.bsp.h5", "-o", f"{{}}/{name}.undone.bsp.h5"):
        c.matrix(f"{name}.undone.bsp.h5")
    if all_steps:
        made.append(f"{name}.best")
    for matrix in made:
        for codec in codecs:
            if not c.run("encode", f"{{}}/{matrix}.bsp.h5", "--codec", codec, "-o", "{}/coded.vmat"):
                continue
            c.payload("coded.vmat")
            c.run("decode", "{}/coded.vmat", "-o", "{}/decoded.bsp.h5")
            c.matrix("decoded.bsp.h5")
            c.run("row", "{}/coded.vmat", "5", output=lambda text: text)
            c.run("node", "{}/coded.vmat", "1", "--ids", output=lambda text: text)
            if subprocess.run([c.programs[1], "decode", c.files("coded.vmat")[0], "-o", c.folder / "old.bsp.h5"], capture_output=True).returncode:
                c.differ("old files", f"{matrix}, {codec}")
            else:
                old, now = h5_contents(c.folder / "old.bsp.h5"), h5_contents(c.files("decoded.bsp.h5")[0])
                c.note("old files decoded", old == now, f"{matrix}, {codec}")


def main():
    parser = argparse.ArgumentParser(description=__doc__, formatter_class=argparse.RawDescriptionHelpFormatter)
    parser.add_argument("before"), parser.add_argument("after"), parser.add_argument("level")
    parser.add_argument("--folder", type=pathlib.Path)
    names = (*ARTIFICIAL, "power-plant", "level-cells", "level-faces")
    parser.add_argument("--sets", default=",".join(names), help="these alone, of " + ", ".join(names))
    arguments = parser.parse_args()
    sets = arguments.sets.split(",")
    with tempfile.TemporaryDirectory() as temporary:
        c = Comparison(arguments.before, arguments.after, arguments.folder or pathlib.Path(temporary))
        for side in ("before", "after"):
            (c.folder / side).mkdir(parents=True, exist_ok=True)
        codecs = codecs_of(arguments.before)
        for name in sets:
            print(f"{name}, {len(codecs)} codecs", flush=True)
            if name in ARTIFICIAL:
                c.run("city", "--size", ARTIFICIAL[name], "-o", f"{{}}/{name}.scene.h5")
                c.run("see", f"{{}}/{name}.scene.h5", "--producer", "climbing", "-o", f"{{}}/{name}.bsp.h5")
            elif name == "power-plant":
                c.run("generate", name, "--scale", "0.004", "-o", f"{{}}/{name}.bsp.h5")
            else:
                c.run("import", arguments.level, "--matrix", name.split("-")[1], "-o", f"{{}}/{name}.bsp.h5")
            compare_matrix(c, name, codecs, name not in ("artificial-2", "level-faces"))
    for line in c.extended:
        print(f"more than before, {line}")
    for kind, count in sorted(c.compared.items()):
        print(f"{count:7} compared: {kind}")
    print(f"{len(c.different):7} different")
    sys.exit(bool(c.different))


if __name__ == "__main__":
    main()
