# SPDX-License-Identifier: MIT
"""Finds equal rows of arrays."""

import numpy as np

_FACTOR = np.uint64(0x9E3779B97F4A7C15)
_SHIFT = np.uint64(29)


def first_equal(*columns):
    """For each row the number of the first row that is equal to it in all `columns`.

    columns: arrays with the same number of rows, of numbers. -0 equals 0. Rows are compared by a hash of 64
    bits, which is checked; should two different rows ever share one, they are compared one by one."""
    columns = [np.asarray(column).reshape(len(column), -1) for column in columns]
    columns = [column + column.dtype.type(0) if column.dtype.kind == "f" else column for column in columns]
    rows = len(columns[0])
    hashes = np.zeros(rows, np.uint64)
    for column in columns:
        for number in column.T:
            hashes ^= _words(number)
            hashes *= _FACTOR
            hashes ^= hashes >> _SHIFT
    _, first, inverse = np.unique(hashes, return_index=True, return_inverse=True)
    found = first[inverse.reshape(-1)]
    if all(np.array_equal(column, column[found]) for column in columns):
        return found
    seen = {}
    keys = zip(*(map(bytes, np.ascontiguousarray(column)) for column in columns))
    return np.array([seen.setdefault(key, row) for row, key in enumerate(keys)], np.int64)


def _words(number):
    if number.dtype.kind == "f":
        return np.ascontiguousarray(number, np.float32).view(np.uint32).astype(np.uint64)
    return number.astype(np.uint64)


def repeated_triangles(triangles):
    """Which triangles name a vertex twice, and which have the vertices of an earlier one: two masks."""
    low, high = triangles.min(axis=1), triangles.max(axis=1)
    middle = triangles.sum(axis=1) - low - high
    twice = (low == middle) | (middle == high)
    first = first_equal(np.stack((low, middle, high), axis=1))
    return twice, first != np.arange(len(triangles))
