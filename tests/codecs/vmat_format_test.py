"""docs/vmat.md against the program: vmat_reader.py, which was written after the page, reads the page's own file byte by byte, and
larger ones that the program wrote.

    vmat_format_test.py SOURCE_TREE VISMAT
"""
import pathlib
import random
import re
import subprocess
import sys
import tempfile
import unittest

import h5py

from vmat_reader import Clusters, File, Gotsman, ModelledRows, delimiter_bytes, part_places, read_bands, read_groups, read_levels, read_names, read_order, read_tree, row_tables, rows_of

SOURCE, VISMAT = pathlib.Path(sys.argv[1]), sys.argv[2]
PAGE = (SOURCE / "docs/vmat.md").read_text()


class Format(unittest.TestCase):
    def test_the_pages_own_file(self):
        block = re.search(r"^A whole file.*?```\n(.*?)```", PAGE, re.M | re.S).group(1)
        file = File(bytes.fromhex(block))
        self.assertEqual((file.codec, file.rows, file.columns, file.ones), ("delimiter", 3, 40, 5))
        self.assertEqual([file.row(row) for row in range(3)], [[0], [], [3, 4, 5, 39]])
        with tempfile.TemporaryDirectory() as folder:
            path = pathlib.Path(folder) / "page.vmat"
            path.write_bytes(bytes.fromhex(block))
            said = subprocess.run([VISMAT, "row", path, "2"], check=True, capture_output=True, text=True).stdout
            self.assertEqual(said.split(), ["3", "4", "5", "39"])

    def test_the_pages_sections(self):
        found = re.findall(r"^\| (order|tree|groups|names|levels|bands|index) \| ([^|]+) \| `([0-9a-f]+)` \|$", PAGE, re.M)
        vectors = [(kind, bytes.fromhex(code)) for kind, _, code in found]
        self.assertEqual([kind for kind, _ in vectors],
                         ["order", "order", "tree", "tree", "tree", "groups", "names", "levels", "bands", "index"])
        data = [code for _, code in vectors]
        self.assertEqual(read_order(data[0], 10), [3, 4, 5, 6, 0, 1, 2, 9, 8, 7])
        self.assertEqual(read_order(data[1], 23), [i * 7 % 23 for i in range(23)])
        self.assertEqual(read_tree(data[2]), ([None, 0, 0, 1, 1, 2, 2], [None, None, None, 0, 1, 2, 3], 4, False))
        self.assertEqual(read_tree(data[3]), ([None, 0, 1, 1, 0, 4, 4], [None, None, 2, 0, None, 1, 2], 3, True))
        self.assertEqual(read_tree(data[4]), ([None, 0, 0, 2, 1, 2, 1], [5, 0, 0, 0, None, 4, None], 6, False))
        self.assertEqual(read_groups(data[5]), [1, 1, 0, 2, 1, 2])
        self.assertEqual(read_names(data[6]), ["wall 1", "wall 12", "wall", ""])
        self.assertEqual(read_levels(data[7]), [(0, 0), (0, 1), (7, 3), (2, 0)])
        self.assertEqual(read_bands(data[8]), [0, 64, 99])
        self.assertEqual(part_places(data[9], 30), [1, 1, 4, 9, 30])

    def test_orders_trees_and_groups_that_the_program_writes(self):
        random.seed(3)
        with tempfile.TemporaryDirectory() as folder:
            folder = pathlib.Path(folder)

            def run(*arguments):
                subprocess.run([VISMAT, *arguments], check=True, capture_output=True)

            run("city", "--size", "4", "-o", folder / "city.scene.h5")
            run("see", folder / "city.scene.h5", "--producer", "climbing", "--objects", "-o", folder / "city.bsp.h5")
            run("order", folder / "city.bsp.h5", "--columns", "random", "--rows", "greedy", "-o", folder / "ordered.bsp.h5")
            run("merge", folder / "city.bsp.h5", "--lost", ".1", "-o", folder / "merged.bsp.h5")
            run("deltas", folder / "city.bsp.h5", "-o", folder / "deltas.bsp.h5")
            run("order", folder / "deltas.bsp.h5", "--columns", "identity", "--rows", "greedy", "-o", folder / "moved.bsp.h5")
            with h5py.File(folder / "moved.bsp.h5") as source:
                self.assertIn("list_rows", source["vismat"])
            for name in ("ordered", "merged", "moved"):
                run("encode", folder / f"{name}.bsp.h5", "-o", folder / "m.vmat")
                file = File((folder / "m.vmat").read_bytes())
                with h5py.File(folder / f"{name}.bsp.h5") as source:
                    stored = source["vismat"]
                    for key, n in (("row_order", file.rows), ("column_order", file.columns)):
                        section = file.sections[key.replace("_", " ")]
                        self.assertEqual(key in stored, bool(section))
                        if section:
                            self.assertEqual(read_order(section, n), list(stored[key]))
                    for key in ("row_groups", "column_groups", "list_rows"):
                        self.assertEqual(key in stored, bool(file.sections[key.replace("_", " ")]))
                        if key in stored:
                            self.assertEqual(read_groups(file.sections[key.replace("_", " ")]), list(stored[key]))
                    parents, objects, count, nodes = read_tree(file.sections["tree"])
                    none = 0xffffffff
                    self.assertEqual([none if p is None else p for p in parents], list(stored["tree/parent"]))
                    self.assertEqual([none if o is None else o for o in objects], list(stored["tree/object"]))
                    self.assertEqual((count, nodes), (file.columns, False))

    def test_the_pages_delimiter_vector(self):
        expected = re.search(r"^\| delimiter \| `([0-9a-f]+)` \|$", PAGE, re.M).group(1)
        self.assertEqual(delimiter_bytes([5, 2, 1, 1, 3, 1, 70, 4, 1, 2]).hex(), expected)

    def test_the_pages_clusters(self):
        model, row = re.search(r"^A model and a row of 24 columns: `([0-9a-f]+)`\n`([0-9a-f]+)`", PAGE, re.M).groups()
        self.assertEqual(Clusters(bytes.fromhex(model), 24).row(bytes.fromhex(row)), [1, 3, 5, 6, 8, 20, 21, 22])

    def test_the_pages_rows(self):
        rows = [[c for c in range(300) if (c - 7 * r) % 60 < 13 or c == 37 * r] for r in range(9)]
        rows[4], rows[6] = rows[3], []
        vectors = re.findall(r"^\| `(bv|rows-fast-ids|rows-fast-bits)` \| `([0-9a-f]+)` \| `([0-9a-f]+)` \|$", PAGE, re.M)
        self.assertEqual([codec for codec, _, _ in vectors], ["bv", "rows-fast-ids", "rows-fast-bits"])
        for codec, index, payload in vectors:
            self.assertEqual(rows_of(codec, 9, 300, bytes.fromhex(index), bytes.fromhex(payload)), rows, codec)

    def test_what_the_program_writes(self):
        random.seed(1)
        rows = [sorted(random.sample(range(300), count)) for count in (0, 1, 5, 300, 150, 20, 3)] * 30
        rows.append(list(range(40, 260)))
        lines = [f"{r + 1} {c + 1}" for r, row in enumerate(rows) for c in row]
        with tempfile.TemporaryDirectory() as folder:
            folder = pathlib.Path(folder)
            (folder / "m.mtx").write_text(f"%%MatrixMarket matrix coordinate pattern general\n{len(rows)} 300 {len(lines)}\n" + "\n".join(lines) + "\n")
            for codec in ("delimiter", "bitmap", "panne", "bv", "rows-fast-ids", "rows-fast-bits"):
                subprocess.run([VISMAT, "encode", folder / "m.mtx", "--codec", codec, "-o", folder / "m.vmat"], check=True, capture_output=True)
                file = File((folder / "m.vmat").read_bytes())
                for r, row in enumerate(rows):
                    self.assertEqual(file.row(r), row, f"{codec}, row {r}")

    def test_the_pages_gotsman_vectors(self):
        matrices = {
            "small": (8, [[0, 1, 2, 5], [0, 1, 2, 6], [1, 2, 3, 6], [3, 6]]),
            "large": (64, [[c for c in range(64) if (c - 3 * r) % 64 < 12 or (c % 8 == 0 and r % 4 < 2 and c < 60 and c != 24)]
                           for r in range(16)]),
        }
        vectors = re.findall(r"^\| `(gotsman[^`]*)` \| (small|large) \| `([0-9a-f]+)` \| `([0-9a-f]+)` \|$", PAGE, re.M)
        self.assertEqual(len(vectors), 5)
        for codec, matrix, index, payload in vectors:
            columns, rows = matrices[matrix]
            n = len(rows)
            children = [(2 * i + 1, 2 * i + 2) if i < n - 1 else () for i in range(2 * n - 1)]
            read = Gotsman(codec, columns, children, range(1 - n, n), bytes.fromhex(index), bytes.fromhex(payload))
            self.assertEqual([read.rows[r] for r in range(n)], rows, f"{codec}, {matrix}")

    def test_the_pages_modelled_rows(self):
        vectors = re.findall(r"^\| `(rows-[^`]*)` \| ([0-9 ]+) \| `([0-9a-f]+)` \| `([0-9a-f]+)` \|$", PAGE, re.M)
        self.assertEqual(len(vectors), 3)
        tables = row_tables((SOURCE / "codecs/modelled/row_tables.cpp").read_text())
        for codec, order, index, payload in vectors:
            rows = [[c for c in range(40) if (7 * c + 3 * r) % 40 < 12 + r % 3] for r in map(int, order.split())]
            self.assertEqual(ModelledRows(len(rows), 40, bytes.fromhex(index), bytes.fromhex(payload), tables).rows, rows, codec)

    def test_modelled_rows_that_the_program_writes(self):
        random.seed(4)
        tables = row_tables((SOURCE / "codecs/modelled/row_tables.cpp").read_text())
        seen, rows = set(range(30, 150)), []
        for r in range(200):
            for _ in range(3):
                start = random.randrange(290)
                seen ^= set(range(start, min(300, start + random.randrange(1, 40))))
            rows.append(sorted(seen) if r % 40 else sorted(random.sample(range(300), 150)))
        runs = [range(start, start + random.randrange(5, 40)) for start in range(20, 1980, 49)]
        few = [sorted(set().union(*random.sample(runs, 3), {7 * r})) for r in range(200)]  # runs that come again and again
        said_of = [self.modelled_rows_of_the_program(*matrix, tables) for matrix in ((rows, 300), (few, 2020))]
        self.assertTrue(any(read.names_second for read in said_of))
        self.assertTrue(any(read.common for read in said_of))

    def modelled_rows_of_the_program(self, rows, columns, tables):
        lines = [f"{r + 1} {c + 1}" for r, row in enumerate(rows) for c in row]
        with tempfile.TemporaryDirectory() as folder:
            folder = pathlib.Path(folder)
            (folder / "m.mtx").write_text(f"%%MatrixMarket matrix coordinate pattern general\n{len(rows)} {columns} {len(lines)}\n" + "\n".join(lines) + "\n")
            for codec in ("rows-small", "rows-quick"):
                subprocess.run([VISMAT, "encode", folder / "m.mtx", "--codec", codec, "-o", folder / "m.vmat"], check=True, capture_output=True)
                file = File((folder / "m.vmat").read_bytes())
                decoded = ModelledRows(file.rows, file.columns, file.sections["index"], file.sections["payload"], tables)
                read = decoded.rows
                self.assertGreater(file.sections["payload"][0], 0)  # rows that readers keep
                self.assertEqual(sum(map(len, read)), file.ones, codec)
                for r in (0, 1, 77, file.rows - 1):
                    for numbers, expected in (["--as-stored"], read[r]), ([], rows[r]):
                        said = subprocess.run([VISMAT, "row", folder / "m.vmat", str(r), *numbers], check=True, capture_output=True, text=True).stdout
                        self.assertEqual(list(map(int, said.split())), expected, f"{codec}, row {r} {numbers}")
            return decoded

    def test_what_the_program_writes_over_a_tree_of_rows(self):
        random.seed(2)
        lines, seen = [], set(range(40, 90))
        for r in range(150):
            for _ in range(3):
                seen ^= set(range(start := random.randrange(200), start + random.randrange(9)))
            lines += [f"{r + 1} {c + 1}" for c in sorted(seen)]
        rows = [[] for _ in range(150)]
        for line in lines:
            r, c = map(int, line.split())
            rows[r - 1].append(c - 1)
        with tempfile.TemporaryDirectory() as folder:
            folder = pathlib.Path(folder)
            (folder / "m.mtx").write_text(f"%%MatrixMarket matrix coordinate pattern general\n150 220 {len(lines)}\n" + "\n".join(lines) + "\n")
            subprocess.run([VISMAT, "tree", folder / "m.mtx", "--side", "rows", "--by", "sets", "-o", folder / "m.bsp.h5"], check=True, capture_output=True)
            for codec in ("gotsman1", "gotsman2", "gotsman3", "gotsman3-context"):
                subprocess.run([VISMAT, "encode", folder / "m.bsp.h5", "--codec", codec, "-o", folder / "m.vmat"], check=True, capture_output=True)
                file = File((folder / "m.vmat").read_bytes())
                parents, row_of_node, objects, nodes = read_tree(file.sections["row tree"])
                self.assertEqual((objects, nodes), (150, False))
                children = [[] for _ in parents]
                for node in range(1, len(parents)):
                    children[parents[node]].append(node)
                read = Gotsman(codec, file.columns, children, row_of_node, file.sections["index"], file.sections["payload"])
                self.assertEqual([read.rows[r] for r in range(150)], rows, codec)
                said = subprocess.run([VISMAT, "row", folder / "m.vmat", "17"], check=True, capture_output=True, text=True).stdout
                self.assertEqual(list(map(int, said.split())), rows[17], codec)


if __name__ == "__main__":
    unittest.main(argv=sys.argv[:1])
