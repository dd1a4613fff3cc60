"""The values of all faces."""

from __future__ import annotations

import json
from collections.abc import Iterable, Mapping
from functools import cached_property
from typing import TYPE_CHECKING, Any

import numpy as np
from numpy.typing import NDArray

from . import _native
from ._colors import ColorScale
from ._given import texts
from .errors import UsageError

if TYPE_CHECKING:
    from typing_extensions import Unpack

    from .settings import ColorsSettings

#: Names of all quantities, in the order of CSV columns.
QUANTITIES: tuple[str, ...] = tuple(row[0] for row in _native.quantities())
#: What the codes of ``face_class`` mean.
CLASSES: Mapping[int, str] = dict(_native.class_names())
#: What the codes of ``method_code`` mean; the first, the empty text, is for faces without an estimate.
METHODS: tuple[str, ...] = tuple(_native.method_names())

_FIELD_OF = {"class": "face_class"}


class FaceCurvature:
    """Curvature of every face of a mesh, in the order of its faces; n is their number.

    Every field is an array that is made when it is first asked for, and is kept then. Values are in the units and axes
    of the vertices. A face without an estimate (no area, or a coordinate that is NaN or infinite) has class -1 and NaN
    everywhere else but in ``coverage`` and ``confidence``, which are 0. Formulas and sources: docs/quantities.md.
    """

    #: The settings that decide the values, with their defaults, as they stand in files.
    settings: dict[str, Any]
    #: Counts of faces, vertices, edges of each kind, components and defects, and bounds: as ``inspect`` has them.
    report: dict[str, Any]
    #: One sentence for each kind of defect; empty for a sound mesh.
    defects: list[str]

    def __init__(
        self, values: _native.Values, settings: dict[str, Any], report: dict[str, Any], defects: list[str]
    ) -> None:
        self._values = values
        self.settings = settings
        self.report = report
        self.defects = defects

    def __len__(self) -> int:
        return len(self._values)

    def __repr__(self) -> str:
        estimated = int(np.count_nonzero(self.estimated))
        return f"<osculate.FaceCurvature of {len(self)} faces, {estimated} estimated>"

    @cached_property
    def face(self) -> NDArray[np.uint32]:
        """Number of each face, 0 to n - 1, (n,)."""
        return self._values.column("face")

    @cached_property
    def face_class(self) -> NDArray[np.int8]:
        """Class, (n,): 0 flat, 1 parabolic, 2 elliptic, 3 umbilic, 4 hyperbolic, -1 not estimated (``CLASSES``)."""
        return self._values.column("class")

    @cached_property
    def k_max(self) -> NDArray[np.float32]:
        """Largest normal curvature, 1/length, (n,). Positive where the surface bends away from its normal: a ball of
        radius r with outward normals has 1/r."""
        return self._values.column("k_max")

    @cached_property
    def k_min(self) -> NDArray[np.float32]:
        """Smallest normal curvature, 1/length, (n,); at most ``k_max`` in value."""
        return self._values.column("k_min")

    @cached_property
    def mean(self) -> NDArray[np.float32]:
        """Mean curvature (k_max + k_min) / 2, 1/length, (n,)."""
        return self._values.column("mean")

    @cached_property
    def gauss(self) -> NDArray[np.float32]:
        """Gaussian curvature k_max k_min, 1/length^2, (n,)."""
        return self._values.column("gauss")

    @cached_property
    def gauss_perimeter(self) -> NDArray[np.float32]:
        """Gaussian curvature from the perimeter of the disk, 1/length^2, (n,). With the default estimator NaN unless
        ``attributes`` asked for it, since it costs a walk."""
        return self._values.column("gauss_perimeter")

    @cached_property
    def shape_index(self) -> NDArray[np.float32]:
        """Shape index (2/pi) atan2(k_max + k_min, k_max - k_min), -1 (cup) to 1 (cap), (n,); 0 for a plane."""
        return self._values.column("shape_index")

    @cached_property
    def curvedness(self) -> NDArray[np.float32]:
        """Curvedness sqrt((k_max^2 + k_min^2) / 2), 1/length, (n,)."""
        return self._values.column("curvedness")

    @cached_property
    def dir_max(self) -> NDArray[np.float32]:
        """Unit tangent of ``k_max``, (n, 3); its sign means nothing."""
        return self._values.column("dir_max")

    @cached_property
    def dir_min(self) -> NDArray[np.float32]:
        """Unit tangent of ``k_min``, (n, 3): normal x ``dir_max``."""
        return self._values.column("dir_min")

    @cached_property
    def radius(self) -> NDArray[np.float32]:
        """How far the mesh counted: largest distance of what the values come from, length, (n,)."""
        return self._values.column("radius")

    @cached_property
    def coverage(self) -> NDArray[np.float32]:
        """Share of that which no border or sharp edge cuts, 0 to 1, (n,)."""
        return self._values.column("coverage")

    @cached_property
    def method_code(self) -> NDArray[np.int8]:
        """How the face came by its values, as an index into ``METHODS``, (n,)."""
        return self._values.column("method")

    @cached_property
    def method(self) -> NDArray[np.str_]:
        """How the face came by its values, (n,): fit, one_sided, strip, flat, patches, window or sections;
        empty without an estimate."""
        return np.array(METHODS)[self.method_code]

    @cached_property
    def confidence(self) -> NDArray[np.float32]:
        """How far to trust the face, 0 to 1, (n,): 1/2 where the expected error is a twentieth of the curvature."""
        return self._values.column("confidence")

    @cached_property
    def estimated(self) -> NDArray[np.bool_]:
        """Which faces have an estimate, (n,)."""
        return self.face_class >= 0

    @property
    def attributes(self) -> tuple[str, ...]:
        """Names of the quantities that the setting ``attributes`` chose: what tables and bridges get."""
        return tuple(self._values.selected())

    def __getitem__(self, name: str) -> NDArray[Any]:
        """A quantity by the name it has in CSV and in ``attributes``, such as ``"k_max"`` or ``"class"``."""
        if name not in QUANTITIES:
            raise UsageError(f"there is no quantity {name}; there are {', '.join(QUANTITIES)}")
        array: NDArray[Any] = getattr(self, _FIELD_OF.get(name, name))
        return array

    def columns(self, attributes: Iterable[str] | None = None) -> dict[str, NDArray[Any]]:
        """The columns of a CSV file, by name: numbers (n,), directions as three of them, ``method`` as text.

        ``attributes`` names quantities; by default those that the setting of that name chose.
        """
        columns: dict[str, NDArray[Any]] = {}
        names = {row[0]: row[1] for row in _native.quantities()}
        for name in self.attributes if attributes is None else attributes:
            array = self[name]
            if array.ndim == 1:
                columns[name] = array
            else:
                columns.update((column, array[:, i]) for i, column in enumerate(names[name]))
        return columns

    def select(self, condition: str) -> NDArray[np.bool_]:
        """Which faces fulfil a condition of ``--select``, (n,), such as ``"class=hyperbolic and k_max>0.1"``.

        A face without the value fulfils no comparison.
        """
        return self._values.select(condition)

    def summary(self) -> dict[str, Any]:
        """Number of estimated faces, count of each class, and percentiles of each quantity."""
        summary: dict[str, Any] = json.loads(self._values.summary())
        return summary

    def color_scale(self, **settings: Unpack[ColorsSettings]) -> ColorScale:
        """Colours of the faces, with the map and the range that they come from.

        Settings, as on the command line: ``color_by`` ("mean"), ``colormap`` (the quantity's own) and ``range``
        ("auto": to the 95th percentile of the magnitudes; or a pair of numbers).
        """
        return ColorScale(*self._values.colors(texts("colors", settings)))

    def colors(self, **settings: Unpack[ColorsSettings]) -> NDArray[np.uint8]:
        """sRGB colours of the faces, (n, 3), with the settings of ``color_scale``."""
        return self.color_scale(**settings).colors

    def __reduce__(self) -> tuple[Any, ...]:
        return _restored, (self._values.pack(), list(self.attributes), self.settings, self.report, self.defects)


def _restored(
    packed: bytes, attributes: list[str], settings: dict[str, Any], report: dict[str, Any], defects: list[str]
) -> FaceCurvature:
    return FaceCurvature(_native.Values.unpack(packed, attributes), settings, report, defects)
