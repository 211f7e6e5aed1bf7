"""What in a table decides how the methods rank on it, measured on the tables themselves.

    bench/reproduce/table_structure.py MATRIX.bsp.h5 ... > OUT/zach2003_structure.csv

    distinct_columns   share of the columns that is left when identical ones are kept once
    row_run            mean length of a run of equal bits along a row of the table, in bits
    bzip2_distinct     bytes that bzip2 -9 needs for the distinct columns alone, in their order
"""
import bz2
import json
import pathlib
import sys

import h5py
import numpy


def dense_table(path):
    """The matrix of a Binsparse CSR file with one byte for each entry."""
    with h5py.File(path) as file:
        starts, ids = file["pointers_to_1"][:].astype(numpy.int64), file["indices_1"][:]
        shape = json.loads(file.attrs["binsparse"])["binsparse"]["shape"]
    dense = numpy.zeros(shape, numpy.uint8)
    dense[numpy.repeat(numpy.arange(shape[0]), numpy.diff(starts)), ids] = 1
    return dense


def bitmap(dense):
    """Rows padded to bytes, the lowest bit first."""
    return numpy.packbits(dense, axis=1, bitorder="little").tobytes()


def distinct_columns(dense):
    """The first of each set of identical columns, in their order."""
    columns = numpy.ascontiguousarray(numpy.packbits(dense, axis=0).T)
    _, first = numpy.unique(columns.view(numpy.dtype((numpy.void, columns.shape[1]))), return_index=True)
    return dense[:, numpy.sort(first)]


def main(paths):
    print("matrix,distinct_columns,row_run,bzip2_distinct")
    for path in paths:
        dense = dense_table(path)
        distinct = distinct_columns(dense)
        runs = dense.shape[0] + numpy.count_nonzero(dense[:, 1:] != dense[:, :-1])
        print(pathlib.Path(path).name.removesuffix(".bsp.h5"), f"{distinct.shape[1] / dense.shape[1]:.4f}", f"{dense.size / runs:.2f}",
              len(bz2.compress(bitmap(distinct))), sep=",", flush=True)


if __name__ == "__main__":
    main(sys.argv[1:])
