"""pandas and Arrow: one row per face, columns as in a CSV file."""

from __future__ import annotations

from collections.abc import Iterable
from typing import Any

import numpy as np
from numpy.typing import NDArray

from .._curvature import METHODS, FaceCurvature
from ..errors import UsageError
from ._common import needed


def to_pandas(curvature: FaceCurvature, attributes: Iterable[str] | None = None) -> Any:
    """A ``pandas.DataFrame``: columns of ``curvature.columns``, ``method`` as a categorical."""
    pandas = needed("pandas")
    columns = curvature.columns(attributes)
    if "method" in columns:
        columns["method"] = pandas.Categorical.from_codes(curvature.method_code, categories=list(METHODS))
    return pandas.DataFrame(columns, copy=False)


def to_arrow(curvature: FaceCurvature, attributes: Iterable[str] | None = None) -> Any:
    """A ``pyarrow.Table``: columns of ``curvature.columns``, ``method`` as a dictionary; null where a face has no such
    value. Numbers that all faces have are not copied."""
    pyarrow = needed("pyarrow")
    columns: dict[str, Any] = {}
    for name, array in curvature.columns(attributes).items():
        if name == "method":
            columns[name] = pyarrow.DictionaryArray.from_arrays(
                pyarrow.array(curvature.method_code), pyarrow.array(list(METHODS))
            )
        else:
            columns[name] = pyarrow.array(np.ascontiguousarray(array), from_pandas=array.dtype.kind == "f")
    return pyarrow.table(columns)


def arrays(vertices: Any, faces: Any) -> tuple[NDArray[Any], NDArray[Any]]:
    """Vertices (n, 3) and faces (m, 3) from two tables of three columns of numbers each, of pandas or Arrow."""
    return _columns(vertices, "vertices"), _columns(faces, "faces")


def _columns(table: Any, name: str) -> NDArray[Any]:
    names = getattr(table, "column_names", None)
    columns = [table.column(column) for column in names] if names else [table[column] for column in table.columns]
    if len(columns) != 3:
        raise UsageError(f"the table of {name} must have three columns, not {len(columns)}")
    return np.column_stack([column.to_numpy() for column in columns])
