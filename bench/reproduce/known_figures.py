"""What is known of the level oa_koth1 of openarena-081-maps, against what vismat reads from it.

    bench/reproduce/known_figures.py VISMAT LEVEL     prints a line for each figure, "ok" or "differs"; exits with 1 if one differs

The bitmap is packed here and compressed by gzip(1) itself, so that none of our codecs vouches for itself.
"""
import pathlib
import re
import subprocess
import sys
import tempfile

from table_structure import bitmap, dense_table


def main(vismat, level):
    def run(*words):
        return subprocess.run([vismat, *words], check=True, capture_output=True, text=True).stdout

    with tempfile.TemporaryDirectory() as folder:
        cells, faces, packed = (str(pathlib.Path(folder) / name) for name in ("c.bsp.h5", "f.bsp.h5", "c.vmat"))
        run("import", level, "--matrix", "cells", "--tree", "none", "-o", cells)
        run("import", level, "--matrix", "faces", "--tree", "none", "-o", faces)
        cells_table, faces_table = dense_table(cells), dense_table(faces)
        quake = re.search(r"(\d+) bytes of payload", run("encode", cells, "--codec", "quake-rle", "-o", packed)).group(1)
        gzip = subprocess.run(["gzip", "-9", "-n"], input=bitmap(cells_table), check=True, capture_output=True).stdout
    figures = [("clusters", cells_table.shape[0], 2415), ("per cent visible", round(100 * cells_table.mean(), 1), 16.9),
               ("bytes as a bitmap", len(bitmap(cells_table)), 729330), ("bytes as Quake RLE", int(quake), 353625),
               ("bytes after gzip -9 -n", len(gzip), 104402), ("face columns", faces_table.shape[1], 2200),
               ("bytes as a bitmap, faces", len(bitmap(faces_table)), 664125)]
    for what, ours, known in figures:
        print(f"oa_koth1: {what:<25} {ours:>9}  {'ok' if ours == known else f'differs, {known} is known'}")
    return any(ours != known for _, ours, known in figures)


if __name__ == "__main__":
    sys.exit(main(*sys.argv[1:]))
