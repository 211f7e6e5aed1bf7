"""What is known of the level oa_koth1 of openarena-081-maps, against what vismat reads from it.

    bench/known_figures.py VISMAT LEVEL     a line a figure, "ok" or "differs"; exits 1 if one differs

The bitmap is packed here and compressed by gzip(1) itself, so that none of our codecs vouches for itself.
"""
import json
import pathlib
import re
import subprocess
import sys
import tempfile

import h5py
import numpy


def bitmap(path):
    """Rows padded to bytes, the lowest bit first, from a Binsparse CSR file."""
    with h5py.File(path) as file:
        starts, ids = file["pointers_to_1"][:].astype(numpy.int64), file["indices_1"][:]
        columns = json.loads(file.attrs["binsparse"])["binsparse"]["shape"][1]
    dense = numpy.zeros((len(starts) - 1, columns), numpy.uint8)
    dense[numpy.repeat(numpy.arange(len(starts) - 1), numpy.diff(starts)), ids] = 1
    return dense, numpy.packbits(dense, axis=1, bitorder="little").tobytes()


def main(vismat, level):
    def run(*words):
        return subprocess.run([vismat, *words], check=True, capture_output=True, text=True).stdout

    with tempfile.TemporaryDirectory() as folder:
        cells, faces, packed = (str(pathlib.Path(folder) / name) for name in ("c.bsp.h5", "f.bsp.h5", "c.vmat"))
        run("import", level, "--matrix", "cells", "--tree", "none", "-o", cells)
        run("import", level, "--matrix", "faces", "--tree", "none", "-o", faces)
        dense, table = bitmap(cells)
        dense_faces, table_faces = bitmap(faces)
        quake = re.search(r"(\d+) bytes of payload", run("encode", cells, "--codec", "quake-rle", "-o", packed)).group(1)
        gzip = subprocess.run(["gzip", "-9", "-n"], input=table, check=True, capture_output=True).stdout
    figures = [("clusters", dense.shape[0], 2415), ("per cent visible", round(100 * dense.mean(), 1), 16.9),
               ("bytes as a bitmap", len(table), 729330), ("bytes as Quake RLE", int(quake), 353625),
               ("bytes after gzip -9 -n", len(gzip), 104402), ("face columns", dense_faces.shape[1], 2200),
               ("bytes as a bitmap, faces", len(table_faces), 664125)]
    for what, ours, known in figures:
        print(f"oa_koth1: {what:<25} {ours:>9}  {'ok' if ours == known else f'differs, {known} is known'}")
    return any(ours != known for _, ours, known in figures)


if __name__ == "__main__":
    sys.exit(main(*sys.argv[1:]))
