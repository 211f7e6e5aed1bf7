"""Matrix files of SciPy and NumPy, gzipped ones and pipes, against vismat. Usage: matrix_files_test.py VISMAT"""

import gzip
import itertools
import os
import subprocess
import sys
import tempfile
import unittest
from pathlib import Path

import h5py
import numpy as np
import scipy.io
import scipy.sparse

VISMAT = os.path.abspath(sys.argv.pop(1))
EXAMPLE = np.array([[0, 1, 0, 1], [0, 0, 0, 0], [1, 1, 1, 0]])
PATTERN = "%%MatrixMarket matrix coordinate pattern general\n3 4 5\n1 2\n1 4\n3 1\n3 2\n3 3\n"


def random_matrix(rows, columns, type=bool, seed=1):
    random = np.random.default_rng(seed)
    values = random.integers(1, 100, (rows, columns)) * (random.random((rows, columns)) < 0.3)
    if np.dtype(type).kind == "c":
        return (values * 1j).astype(type)
    return values.astype(type)


class MatrixFiles(unittest.TestCase):
    def setUp(self):
        self.folder = tempfile.TemporaryDirectory()
        self.path = Path(self.folder.name)

    def tearDown(self):
        self.folder.cleanup()

    def vismat(self, *words, **how):
        return subprocess.run([VISMAT, *words], capture_output=True, cwd=self.path, **how)

    def read(self, name, out="out.mtx", says=None, **how):
        """What vismat reads, as an array; `says` is what it must print."""
        run = self.vismat("convert", name, "-o", out, **how)
        self.assertEqual((run.returncode, run.stderr), (0, b""), name)
        if says is not None:
            self.assertIn(says, run.stdout.decode())
        return scipy.io.mmread(self.path / out).toarray() != 0

    def same(self, name, wanted, **how):
        np.testing.assert_array_equal(self.read(name, **how), np.asarray(wanted) != 0, str(name))

    def refused(self, name, *words, verb="convert", **how):
        before = sorted(os.listdir(self.path))
        run = self.vismat(verb, name, *(["-o", "out.mtx"] if verb != "info" else []), **how)
        error = run.stderr.decode()
        self.assertEqual((run.returncode, error.count("\n"), run.stdout), (1, 1, b""), error)
        for word in words:
            self.assertIn(word, error)
        self.assertEqual(sorted(os.listdir(self.path)), before)

    # -- Matrix Market

    def test_whatever_scipy_writes(self):
        for type in ("i1", "u1", "i4", "u4", "i8", "u8", "f4", "f8", "c8", "c16"):
            for rows, columns in ((7, 5), (1, 1), (3, 0)):
                dense = random_matrix(rows, columns, type)
                for make in (np.asarray, scipy.sparse.csr_matrix, scipy.sparse.coo_matrix, scipy.sparse.csc_matrix):
                    if make is np.asarray and columns == 0:
                        continue  # SciPy writes no header for it
                    scipy.io.mmwrite(self.path / "a.mtx", make(dense))
                    self.same("a.mtx", dense)

    def test_every_symmetry_scipy_writes(self):
        for type, symmetry in itertools.product(("i4", "u2", "f8", "c16"), ("symmetric", "skew-symmetric", "hermitian")):
            if symmetry == "hermitian" and type != "c16":
                continue
            half = np.tril(random_matrix(6, 6, type), -1 if symmetry == "skew-symmetric" else 0)
            if type == "u2" and symmetry == "skew-symmetric":
                continue
            if symmetry == "hermitian":
                half = half - np.diag(np.diag(half)) + np.eye(6)
            strict = np.tril(half, -1)
            other = {"symmetric": strict.T, "skew-symmetric": -strict.T, "hermitian": strict.conj().T}[symmetry]
            whole = half + other
            for make in (np.asarray, scipy.sparse.coo_matrix):
                scipy.io.mmwrite(self.path / "a.mtx", make(whole), symmetry=symmetry)
                self.assertIn(symmetry, (self.path / "a.mtx").read_text().splitlines()[0])
                self.same("a.mtx", whole, says="mirrored")

    def test_scipy_sees_the_same(self):
        for text in (PATTERN.replace("general\n3 4 5", "symmetric\n4 4 5"),
                     PATTERN.replace("pattern", "real").replace("\n1 2\n1 4\n3 1\n3 2\n3 3", "\n1 2 1\n1 2 1\n3 1 2\n3 2 0\n3 3 -4.5e-3"),
                     PATTERN.replace("\n1 2", "\n% between\n\n1 2")):
            (self.path / "a.mtx").write_text(text)
            self.same("a.mtx", scipy.io.mmread(self.path / "a.mtx").toarray())

    def test_repeated_and_zero_entries_are_counted_by_every_verb(self):
        text = PATTERN.replace("pattern", "real").replace(
            "\n1 2\n1 4\n3 1\n3 2\n3 3", "\n1 2 1\n1 2 1\n3 1 2\n3 2 0\n3 3 4")
        (self.path / "a.mtx").write_text(text)
        says = "1 repeated entry merged, 1 entry of value zero left out"
        for words in (("convert", "a.mtx", "-o", "b.h5"), ("info", "a.mtx"), ("encode", "a.mtx", "-o", "b.vmat"),
                      ("order", "a.mtx", "--columns", "best", "-o", "b.h5"), ("verify", "a.mtx", "a.mtx"),
                      ("merge", "a.mtx", "--lost", "0.5", "-o", "b.h5"), ("tree", "a.mtx", "--by", "sets", "-o", "b.h5"),
                      ("deltas", "a.mtx", "--neighbours", "order", "-o", "b.h5")):
            run = self.vismat(*words)
            if words[0] in ("tree", "deltas") and run.returncode:
                continue  # the example may lack what these need
            self.assertEqual(run.stderr, b"")
            self.assertIn(says, run.stdout.decode(), words)

    # -- gzip, pipes, and what is no matrix

    def test_gzipped(self):
        self.vismat("generate", "power-plant", "--scale", "0.002", "-o", "m.mtx")
        wanted = scipy.io.mmread(self.path / "m.mtx").toarray()
        for words in (("convert", "m.mtx", "-o", "m.npy"), ("convert", "m.mtx", "-o", "m.npz"), ("encode", "m.mtx", "-o", "m.vmat")):
            self.assertEqual(self.vismat(*words).returncode, 0)
        for name in ("m.mtx", "m.npy", "m.npz", "m.vmat"):
            whole = (self.path / name).read_bytes()
            half = len(whole) // 2
            (self.path / (name + ".gz")).write_bytes(gzip.compress(whole[:half]) + gzip.compress(whole[half:]) + bytes(7))
            if name == "m.vmat":
                self.assertEqual(self.vismat("verify", name + ".gz", "m.mtx").returncode, 0)
                self.assertEqual(self.vismat("decode", name + ".gz", "-o", "back.mtx").returncode, 0)
                self.assertIn(b"compressed matrix", self.vismat("info", name + ".gz").stdout)
                self.assertEqual(self.vismat("row", name + ".gz", "3").stdout, self.vismat("row", name, "3").stdout)
            else:
                self.same(name + ".gz", wanted)
                self.assertIn(b"gzipped", self.vismat("info", name + ".gz").stdout)
        whole = gzip.compress(PATTERN.encode())
        for cut in (3, 11, len(whole) // 2, len(whole) - 1):
            (self.path / "a.gz").write_bytes(whole[:cut])
            self.refused("a.gz", "a.gz: gzip: ends early")
        (self.path / "a.gz").write_bytes(whole[:-5] + b"!" + whole[-4:])
        self.refused("a.gz", "gzip: is damaged")
        (self.path / "a.gz").write_bytes(whole + b"more")
        self.refused("a.gz", "4 bytes of something else")
        (self.path / "a.gz").write_bytes(gzip.compress(whole))
        self.refused("a.gz", "gzip twice")

    def test_pipes(self):
        (self.path / "m.mtx").write_text(PATTERN)
        for ending in ("npy", "npz", "h5"):
            self.vismat("convert", "m.mtx", "-o", "m." + ending)
        self.vismat("encode", "m.mtx", "-o", "m.vmat")
        for name in ("m.mtx", "m.npy", "m.npz"):
            self.same("/dev/stdin", EXAMPLE, input=(self.path / name).read_bytes())
            self.same("/dev/stdin", EXAMPLE, input=gzip.compress((self.path / name).read_bytes()))
            self.assertIn(b"ones             5", self.vismat("info", "/dev/stdin", input=(self.path / name).read_bytes()).stdout)
        vmat = (self.path / "m.vmat").read_bytes()
        self.assertIn(b"compressed matrix", self.vismat("info", "/dev/stdin", input=vmat).stdout)
        self.assertEqual(self.vismat("verify", "/dev/stdin", "m.mtx", input=vmat).returncode, 0)
        self.assertEqual(self.vismat("decode", "/dev/stdin", "-o", "out.mtx", input=vmat).returncode, 0)
        self.assertEqual(self.vismat("row", "/dev/stdin", "2", input=vmat).stdout, b"0\n1\n2\n")
        self.assertEqual(self.vismat("verify", "m.vmat", "/dev/stdin", input=PATTERN.encode()).returncode, 0)
        for verb in ("convert", "info"):
            self.refused("/dev/stdin", "not a regular file", verb=verb, input=(self.path / "m.h5").read_bytes())
        with open(self.path / "m.h5") as file:
            self.same("/dev/stdin", EXAMPLE, stdin=file)
        os.mkfifo(self.path / "fifo")
        with subprocess.Popen(["sh", "-c", "cat m.vmat > fifo"], cwd=self.path):
            self.assertEqual(self.vismat("verify", "fifo", "m.mtx").returncode, 0)

    def test_what_is_no_matrix_is_told(self):
        (self.path / "m.mtx").write_text(PATTERN)
        self.vismat("encode", "m.mtx", "-o", "m.vmat")
        self.refused("m.vmat", "compressed matrix (.vmat); 'vismat decode'")
        self.refused("m.mtx", "is no .vmat file, but a matrix, Matrix Market", verb="decode")
        for begin, words in ((b"\xfd7zXZ\0", "with xz"), (b"BZh91AY", "bzip2"), (b"\x28\xb5\x2f\xfd", "zstd"), (b"", "is empty"),
                             (b"glTF\2\0\0\0", ".npy"), (b"3 4 5\n", "'%%MatrixMarket'"), ("\ufeff3".encode("utf-32"), "UTF-32")):
            (self.path / "a").write_bytes(begin)
            self.refused("a", words)
        self.refused("m.mtx:3", "has no parts")
        (self.path / "a").write_bytes(b"glTF")
        self.refused("a", ".npz", ".vmat", ".scene.h5", ".pk3", verb="info")
        (self.path / "a").write_bytes(gzip.compress(b"IBSP"))
        self.refused("a", "is gzipped; unpack it with gunzip first", verb="info")
        self.refused("nothing", "No such file")
        for name in ("a.txt", "a.mat"):
            run = self.vismat("convert", "m.mtx", "-o", name)
            self.assertIn(b"is written as .bsp.h5, .h5, .hdf5, .mtx, .npy or .npz", run.stderr)
            self.assertFalse((self.path / name).exists())

    # -- HDF5

    def test_groups_and_user_blocks(self):
        (self.path / "m.mtx").write_text(PATTERN)
        self.vismat("convert", "m.mtx", "-o", "m.h5")
        for block in (512, 2048, 1 << 16):
            with h5py.File(self.path / "u.h5", "w", userblock_size=block) as to, h5py.File(self.path / "m.h5") as of:
                for name in of:
                    of.copy(name, to)
                for name, value in of.attrs.items():
                    to.attrs[name] = value
            self.same("u.h5", EXAMPLE)
        with h5py.File(self.path / "g.h5", "w") as to, h5py.File(self.path / "m.h5") as of:
            to["x"] = [1]
            for group in ("a", "a/deep", "z:1"):
                of.copy("/", to, name=group)
            of.copy("/", to, name="other")
            del to["other"].attrs["binsparse"]
        for group in ("a", "/a", "/a/", "a/deep", "z:1"):
            self.same("g.h5:" + group, EXAMPLE)
            self.assertIn(b"Binsparse on HDF5", self.vismat("info", "g.h5:" + group).stdout)
        self.refused("g.h5", "the matrix is in group /a, /z:1, /a/deep; name it as FILE:/a")
        self.refused("g.h5:other", "the matrix is in group")
        self.refused("g.h5:none", "/none: is missing")
        run = self.vismat("see", "m.h5", "-o", "x.mtx")
        self.assertIn(b"m.h5: holds a matrix, not a scene", run.stderr)
        self.assertIn(b"m.h5: holds a matrix", self.vismat("scene", "m.h5", "-o", "x.scene.h5").stderr)

    # -- NumPy and SciPy

    def test_npy_of_every_type(self):
        for type in ("?", "i1", "u1", "<i2", ">i4", "<u8", ">u2", "<f2", ">f4", "<f8", ">f8", "<c8", ">c16"):
            for order, (rows, columns) in itertools.product("CF", ((7, 5), (1, 1), (4, 0), (0, 3))):
                dense = np.array(random_matrix(rows, columns, type).astype(type), order=order)
                np.save(self.path / "a.npy", dense)
                self.same("a.npy", dense)
        np.save(self.path / "a.npy", np.array([[-0.0, 0.0, np.nan, 5e-324]]))
        self.same("a.npy", [[0, 0, 1, 1]])
        for version in ((1, 0), (2, 0), (3, 0)):
            with open(self.path / "a.npy", "wb") as file:
                np.lib.format.write_array(file, EXAMPLE, version)
            self.same("a.npy", EXAMPLE)

    def test_packed_bits(self):
        for columns in (1, 7, 8, 9, 64, 65):
            dense = random_matrix(11, columns, seed=columns)
            for order in "CF":
                np.save(self.path / "a.npy", np.array(np.packbits(dense, axis=1), order=order))
                self.same(f"a.npy:{columns}", dense)
            scipy.io.mmwrite(self.path / "a.mtx", scipy.sparse.coo_matrix(dense.astype(int)))
            self.assertEqual(self.vismat("convert", "a.mtx", "-o", f"b.npy:{columns}").returncode, 0)
            np.testing.assert_array_equal(np.load(self.path / "b.npy"), np.packbits(dense, axis=1))
            run = self.vismat("convert", "a.mtx", "-o", f"c.npy:{columns + 1}")
            self.assertIn(f"the matrix has {columns} columns; FILE.npy:{columns} writes".encode(), run.stderr)
            self.assertFalse((self.path / "c.npy").exists())
        np.save(self.path / "a.npy", np.packbits(EXAMPLE != 0, axis=1))
        self.refused("a.npy:9", "1 bytes in a row, not the 2 that 9 columns take")
        self.refused("a.npy:3", "row 0 has bits behind column 2")
        self.refused("a.npy:x", "COLUMNS")
        np.save(self.path / "a.npy", EXAMPLE)
        self.refused("a.npy:4", "type uint8")

    def test_npy_that_is_none(self):
        def refuse(array, *words, **how):
            np.save(self.path / "a.npy", array, **how)
            self.refused("a.npy", *words)
        refuse(np.zeros(3), "1 dimension;")
        refuse(np.zeros((2, 2, 2)), "3 dimensions")
        refuse(np.array([["a"]], object), "type '|O'", allow_pickle=True)
        refuse(np.zeros((1, 1), "M8[s]"), "type '<M8[s]'")
        refuse(np.zeros((1, 1), [("a", "i4"), ("b", "f4")]), "records")
        refuse(np.zeros((1, 1), "g"), "type '<f16'")
        np.save(self.path / "a.npy", EXAMPLE)
        whole = (self.path / "a.npy").read_bytes()
        for cut in (7, 9, 40, len(whole) - 1):
            (self.path / "a.npy").write_bytes(whole[:cut])
            self.refused("a.npy", ".npy")
        for old, new in ((b"'descr'", b"'Descr'"), (b"(3, 4)", b"(3, 5)"), (b"(3, 4)", b"(-3,4)"), (b"False", b"false"),
                         (b"}", b" "), (b"\n", b"x"), (b"NUMPY\1", b"NUMPY\4"), (b"'fortran_order'", b"'descr'        ")):
            (self.path / "a.npy").write_bytes(whole.replace(old, new, 1))
            self.refused("a.npy", ".npy")
        (self.path / "a.npy").write_bytes(whole + b"x")
        self.refused("a.npy", "97 follow")

    def test_npz_of_every_format(self):
        for type, (rows, columns) in itertools.product(("?", "i8", "f4", "c16"), ((6, 9), (1, 1), (3, 6))):
            dense = random_matrix(rows, columns, type)
            for format, packed in itertools.product(("csr", "csc", "coo", "bsr", "dia"), (True, False)):
                sparse = scipy.sparse.coo_matrix(dense).asformat(format)
                if format == "bsr" and rows == 6:
                    sparse = scipy.sparse.bsr_matrix(dense, blocksize=(2, 3))
                scipy.sparse.save_npz(self.path / "a.npz", sparse, compressed=packed)
                self.same("a.npz", dense)
        np.savez(self.path / "a.npz", EXAMPLE)
        self.same("a.npz", EXAMPLE)
        twice = scipy.sparse.coo_matrix(([1, 1, 0, 1], ([0, 0, 1, 2], [1, 1, 1, 0])), shape=(3, 4))
        scipy.sparse.save_npz(self.path / "a.npz", twice)
        self.same("a.npz", twice.toarray(), says="1 repeated entry merged, 1 entry of value zero left out")
        unsorted = scipy.sparse.csr_matrix(([1, 1, 1], [3, 0, 3], [0, 3, 3]), shape=(2, 4))
        scipy.sparse.save_npz(self.path / "a.npz", unsorted)
        self.same("a.npz", [[1, 0, 0, 1], [0, 0, 0, 0]])

    def test_npz_that_is_none(self):
        good = {"format": np.array(b"csr"), "shape": np.array([2, 3]), "data": np.ones(2), "indices": np.array([0, 2]),
                "indptr": np.array([0, 1, 2])}

        def refuse(words, **changes):
            arrays = {name: array for name, array in (good | changes).items() if array is not None}
            np.savez(self.path / "a.npz", **arrays)
            self.refused("a.npz", ".npz: ", words)
        np.savez(self.path / "a.npz", **good)
        self.same("a.npz", [[1, 0, 0], [0, 0, 1]])
        refuse("lacks the member indptr.npy", indptr=None)
        refuse("5 arrays and no format.npy", format=None, more=np.ones(1))
        refuse("names none of csr", format=np.array(b"lil"))
        refuse("indices.npy: item 1 is 3; it must be below 3", indices=np.array([0, 3]))
        refuse("indices.npy: .npy: item 0 is -1", indices=np.array([-1, 0]))
        refuse("holds no integers", indices=np.array([0., 1.]))
        refuse("indptr.npy has 2 items, not 3", indptr=np.array([0, 2]))
        refuse("indptr.npy: item 1 is 3", indptr=np.array([0, 3, 2]))
        refuse("does not begin with 0", indptr=np.array([1, 1, 2]))
        refuse("data.npy has 2 dimensions", data=np.ones((2, 1)))
        refuse("indices.npy has 2 items, not 3", data=np.ones(3))
        refuse("do not fill the matrix", format=np.array(b"bsr"), data=np.ones((1, 2, 2)))
        np.savez(self.path / "a.npz", **(good | {"shape": np.array([1 << 40, 3])}))
        self.refused("a.npz", "indptr.npy has 3 items")
        coo = {"format": np.array(b"coo"), "row": np.array([0]), "col": np.array([0]), "data": np.ones(1)}
        np.savez(self.path / "a.npz", shape=np.array([1 << 31, 3]), **coo)
        self.refused("a.npz", "claims 2147483648 rows")
        whole = (self.path / "a.npz").read_bytes()
        (self.path / "a.npz").write_bytes(whole[: len(whole) // 2])
        self.refused("a.npz", "is no matrix file")

    def test_numpy_and_scipy_read_what_vismat_writes(self):
        for rows, columns in ((7, 65), (1, 1), (3, 4), (300, 200)):
            dense = random_matrix(rows, columns)
            scipy.io.mmwrite(self.path / "a.mtx", scipy.sparse.coo_matrix(dense.astype(int)))
            for name in ("a.npy", "a.npz"):
                self.assertEqual(self.vismat("convert", "a.mtx", "-o", name).returncode, 0)
                self.same(name, dense)
            array = np.load(self.path / "a.npy")
            self.assertEqual((array.dtype, array.flags.c_contiguous), (np.dtype(bool), True))
            np.testing.assert_array_equal(array, dense)
            sparse = scipy.sparse.load_npz(self.path / "a.npz")
            self.assertEqual((sparse.format, sparse.dtype, sparse.has_canonical_format), ("csr", np.dtype(bool), True))
            np.testing.assert_array_equal(sparse.toarray(), dense)
            before = (self.path / "a.npz").read_bytes()
            self.vismat("convert", "a.npz", "-o", "b.npz")
            self.assertEqual((self.path / "b.npz").read_bytes(), before)

    def test_what_an_output_leaves_out_is_told(self):
        self.vismat("city", "--size", "4", "-o", "c.scene.h5")
        self.vismat("see", "c.scene.h5", "--producer", "shadow", "--threads", "1", "-o", "c.h5")
        run = self.vismat("convert", "c.h5", "-o", "c.npz")
        self.assertRegex(run.stdout.decode(), "; without boxes.*provenance, guarantee")
        self.assertNotIn(b"without", self.vismat("convert", "c.h5", "-o", "d.h5").stdout)
        self.assertIn(b"c.mtx: without boxes", self.vismat("order", "c.h5", "--columns", "best", "-o", "c.mtx").stdout)
        for words, lost in ((("deltas", "c.h5"), b"boundaries"), (("tree", "c.h5"), b"tree"), (("merge", "c.h5", "--lost", "0.1"), b"map")):
            for name in ("d.npz", "d.npy", "d.mtx"):
                run = self.vismat(*words, "-o", name)
                self.assertIn(name.encode() + b": has no place for the " + lost, run.stderr)
                self.assertFalse((self.path / name).exists())


if __name__ == "__main__":
    unittest.main()
