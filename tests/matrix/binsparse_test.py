"""Binsparse files between vismat and h5py/scipy, both ways. Usage: binsparse_test.py VISMAT"""

import json
import subprocess
import sys
import tempfile
import unittest
from pathlib import Path

import h5py
import numpy as np
import scipy.io
import scipy.sparse

VISMAT = sys.argv.pop(1)


def matrix(rows=211, columns=137, density=0.2, seed=1):
    random = np.random.default_rng(seed)
    return scipy.sparse.csr_matrix(random.random((rows, columns)) < density)


def same(a, b):
    return a.shape == b.shape and (a.astype(bool) != b.astype(bool)).nnz == 0


def arrays_of(source, format):
    """What the specification asks of each format, as a dict of arrays without the values."""
    by_row, by_column = source.tocsr(), source.tocsc()
    by_row.sort_indices()
    by_column.sort_indices()
    lines = by_column if format.endswith("C") else by_row
    number = np.repeat(np.arange(len(lines.indptr) - 1), np.diff(lines.indptr))
    if format in ("CSR", "CSC"):
        return {"pointers_to_1": lines.indptr, "indices_1": lines.indices}
    if format in ("DCSR", "DCSC"):
        kept = np.flatnonzero(np.diff(lines.indptr))
        return {
            "indices_0": kept,
            "pointers_to_1": np.append(lines.indptr[kept], lines.indptr[-1]),
            "indices_1": lines.indices,
        }
    return {"indices_0": number, "indices_1": lines.indices}  # COO, COOR, COOC


def write(path, source, format, index_type, values=None, how=None, **more):
    arrays = arrays_of(source, format)
    iso = values is None
    values = np.ones(1, np.uint8) if iso else values
    names = {"bool": "bint8"}
    value_type = names.get(values.dtype.name, values.dtype.name)
    if value_type.startswith("complex"):
        value_type = {"complex64": "complex[float32]", "complex128": "complex[float64]"}[value_type]
        values = values.view(values.real.dtype)
    types = {name: index_type for name in arrays} | {"values": f"iso[{value_type}]" if iso else value_type}
    descriptor = {
        "version": "0.1",
        "format": format,
        "shape": list(source.shape),
        "number_of_stored_values": int(source.nnz),
        "data_types": types,
    }
    with h5py.File(path, "w") as file:
        file.attrs["binsparse"] = json.dumps({"binsparse": descriptor | more})
        for name, array in arrays.items():
            file.create_dataset(name, data=array.astype(index_type), **(how or {}))
        file.create_dataset("values", data=values)


class Binsparse(unittest.TestCase):
    def setUp(self):
        self.folder = tempfile.TemporaryDirectory()
        self.path = Path(self.folder.name)

    def tearDown(self):
        self.folder.cleanup()

    def convert(self, source, target):
        run = subprocess.run([VISMAT, "convert", source, "-o", target], capture_output=True, text=True)
        return run.returncode, run.stderr

    def read_back(self, source):
        target = self.path / "out.mtx"
        self.assertEqual(self.convert(source, target), (0, ""))
        return scipy.io.mmread(target).tocsr()

    def test_python_reads_what_vismat_wrote(self):
        # large enough for several chunks
        for source in (matrix(), matrix(3000, 900), scipy.sparse.csr_matrix((5, 0)), scipy.sparse.csr_matrix((3, 4))):
            scipy.io.mmwrite(self.path / "in.mtx", source.astype(int), field="pattern")
            self.assertEqual(self.convert(self.path / "in.mtx", self.path / "a.bsp.h5"), (0, ""))
            with h5py.File(self.path / "a.bsp.h5") as file:
                descriptor = json.loads(file.attrs["binsparse"])["binsparse"]
                self.assertEqual(descriptor["version"], "0.1.0")
                self.assertEqual(descriptor["format"], "CSR")
                self.assertEqual(descriptor["number_of_stored_values"], source.nnz)
                types = descriptor["data_types"]
                self.assertEqual(types["values"], "iso[bint8]")
                for name in ("pointers_to_1", "indices_1"):
                    self.assertEqual(file[name].dtype.name, types[name])
                self.assertEqual(file["values"][:].tolist(), [1])
                self.assertEqual(file["values"].dtype, np.uint8)
                self.assertEqual(file.attrs["vismat_guarantee"], b"unknown")
                found = scipy.sparse.csr_matrix(
                    (np.ones(source.nnz, bool), file["indices_1"][:], file["pointers_to_1"][:]),
                    shape=descriptor["shape"],
                )
            self.assertTrue(same(found, source))

    def test_vismat_reads_each_format_and_index_type(self):
        source = matrix(97, 120, 0.05)  # some rows stay empty
        for format in ("CSR", "CSC", "DCSR", "DCSC", "COO", "COOR", "COOC"):
            for index_type in ("uint16", "int16", "uint32", "int32", "uint64", "int64"):
                with self.subTest(format=format, index_type=index_type):
                    write(self.path / "a.h5", source, format, index_type)
                    self.assertTrue(same(self.read_back(self.path / "a.h5"), source))
        write(self.path / "a.h5", source, "COO", "uint8")
        self.assertTrue(same(self.read_back(self.path / "a.h5"), source))

    def test_vismat_reads_big_endian(self):
        source = matrix()
        write(self.path / "a.h5", source, "CSR", ">u4")
        self.assertTrue(same(self.read_back(self.path / "a.h5"), source))

    def test_vismat_drops_explicit_zeros(self):
        source = matrix(50, 60)
        kept = np.random.default_rng(5).random(source.nnz) < 0.5
        wanted = scipy.sparse.csr_matrix((kept, source.indices, source.indptr), shape=source.shape, copy=True)
        wanted.eliminate_zeros()
        for type in ("bool", "uint8", "int8", "uint16", "int64", "float32", "float64", "complex64", "complex128"):
            with self.subTest(type=type):
                values = kept.astype(type) * (1j if type.startswith("complex") else 1)
                write(self.path / "a.h5", source, "CSR", "uint32", values.astype(type))
                self.assertTrue(same(self.read_back(self.path / "a.h5"), wanted))

    def test_vismat_reads_symmetric_halves(self):
        half = scipy.sparse.tril(matrix(80, 80)).tocsr()
        whole = (half + half.T).astype(bool)
        for format in ("CSR", "CSC", "COO"):
            write(self.path / "a.h5", half, format, "int32", structure="symmetric_lower")
            self.assertTrue(same(self.read_back(self.path / "a.h5"), whole))
            write(self.path / "a.h5", half.T, format, "int32", structure="symmetric_upper")
            self.assertTrue(same(self.read_back(self.path / "a.h5"), whole))

    def test_vismat_reads_chunks_and_filters(self):
        source = matrix(400, 300)
        for how in (
            {"chunks": (100,)},
            {"compression": "gzip"},
            {"compression": "gzip", "shuffle": True, "fletcher32": True},
            {"chunks": (7,), "maxshape": (None,)},
        ):
            with self.subTest(how=how):
                write(self.path / "a.h5", source, "CSR", "int64", how=how)
                self.assertTrue(same(self.read_back(self.path / "a.h5"), source))

    def refused(self, words):
        code, errors = self.convert(self.path / "a.h5", self.path / "never.mtx")
        self.assertEqual(code, 1)
        self.assertEqual(errors.count("\n"), 1)
        self.assertTrue(errors.startswith(f"vismat: {self.path / 'a.h5'}: "), errors)
        self.assertIn(words, errors)
        self.assertFalse((self.path / "never.mtx").exists())

    def test_other_storage_is_refused(self):
        source = matrix()
        write(self.path / "a.h5", source, "CSR", "uint32", how={"compression": "lzf"})
        self.refused("HDF5 filter 32000")
        write(self.path / "a.h5", source, "CSR", "uint32", how={"scaleoffset": 8})
        self.refused("HDF5 filter 6")
        write(self.path / "b.h5", source, "CSR", "uint32")
        for link in (h5py.ExternalLink(self.path / "b.h5", "/indices_1"), h5py.SoftLink("/values")):
            write(self.path / "a.h5", source, "CSR", "uint32")
            with h5py.File(self.path / "a.h5", "a") as file:
                del file["indices_1"]
                file["indices_1"] = link
            self.refused("soft or external link")
        (self.path / "raw").write_bytes(bytes(4 * source.nnz))
        for how in ("external", "virtual"):
            write(self.path / "a.h5", source, "CSR", "uint32")
            with h5py.File(self.path / "a.h5", "a") as file:
                del file["indices_1"]
                if how == "external":
                    file.create_dataset("indices_1", (source.nnz,), "u4", external=[(self.path / "raw", 0, 4 * source.nnz)])
                else:
                    layout = h5py.VirtualLayout((source.nnz,), "u4")
                    layout[:] = h5py.VirtualSource(self.path / "b.h5", "indices_1", (source.nnz,))
                    file.create_virtual_dataset("indices_1", layout)
            self.refused("another file" if how == "external" else "virtual")

    def test_claims_without_bytes_are_refused(self):
        source = matrix()
        for shape, how, words in (
            ((1 << 40,), {"chunks": (1 << 20,), "compression": "gzip"}, "cannot hold"),
            ((1 << 62,), {"chunks": (1 << 20,)}, "more entries than 64 bits"),
            ((1 << 40,), {}, "cannot hold"),
            ((1 << 33, 1 << 33), {"chunks": (1, 1)}, "more entries than 64 bits"),
        ):
            write(self.path / "a.h5", source, "CSR", "uint32")
            with h5py.File(self.path / "a.h5", "a") as file:
                del file["indices_1"]
                data = file.create_dataset("indices_1", shape, "u4", **how)
                if how and shape == (1 << 40,):  # to write into the others crashes the HDF5 library
                    data[0] = 1
            self.refused(words)
        write(self.path / "a.h5", source, "CSR", "uint32")
        with h5py.File(self.path / "a.h5", "a") as file:
            ids = file["indices_1"][:]
            del file["indices_1"]
            data = file.create_dataset("indices_1", ids.shape, "u4", chunks=(1000,))
            data[:1000] = ids[:1000]
        self.refused("cannot hold")

    def test_wrong_contents_are_refused(self):
        source = matrix()
        for type in ("f4", "S4", h5py.string_dtype()):
            write(self.path / "a.h5", source, "CSR", "uint32")
            with h5py.File(self.path / "a.h5", "a") as file:
                del file["indices_1"]
                file.create_dataset("indices_1", data=np.zeros(source.nnz, "S4" if type != "f4" else type).astype(type))
            self.refused("/indices_1: holds")
        write(self.path / "a.h5", source, "CSR", "int64")
        with h5py.File(self.path / "a.h5", "a") as file:
            file["indices_1"][17] = -5
        self.refused("/indices_1: entry 17 is -5")
        with h5py.File(self.path / "a.h5", "a") as file:
            file["indices_1"][17] = 4_000_000_000
        self.refused("/indices_1: entry 17 is 4000000000, but there are 137 columns")
        with h5py.File(self.path / "a.h5", "a") as file:
            file.attrs["binsparse"] = "[" * 100_000
        self.refused("attribute binsparse: is not a JSON object")
        with h5py.File(self.path / "a.h5", "a") as file:
            file.attrs["binsparse"] = 5
        self.refused("attribute binsparse: is not a string")
        with h5py.File(self.path / "a.h5", "w") as file:
            file["scene/indices"] = [1]
        self.refused("holds a scene")
        with h5py.File(self.path / "a.h5", "w") as file:
            file["x"] = [1]
        self.refused("it holds no matrix")


if __name__ == "__main__":
    unittest.main()
