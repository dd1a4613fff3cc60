"""From file to file."""

from __future__ import annotations

import json
from typing import TYPE_CHECKING, Any

from . import _native
from ._given import texts
from ._mesh import Path, warn
from ._progress import Progress, reporting

if TYPE_CHECKING:
    from typing_extensions import Unpack

    from .settings import ConvertSettings, InspectSettings


def convert(
    src: Path,
    dst: Path,
    *,
    summarise: bool = False,
    progress: Progress = None,
    **settings: Unpack[ConvertSettings],
) -> dict[str, Any]:
    """Annotates a mesh file, as ``osculate annotate`` does: ``dst`` is .glb, .gltf, .ply, .csv or .npz.

    Settings are the options of the command, with underscores: ``osculate.settings.ConvertSettings``. A glTF scene
    comes out whole. ``dst`` appears whole or not at all, and is replaced where it exists unless ``no_clobber``.

    Gives what ``--stats`` writes: counts, defects, notes, settings, seconds of each stage; with ``summarise`` also the
    percentiles of all values.

    Raises ``FileError``, ``ParseError``, ``EmptyMeshError``, ``TooLargeError`` or ``UsageError``; warns of defects with
    ``DefectWarning``.
    """
    with reporting(progress) as callback:
        summary, defects = _native.convert(src, dst, texts("convert", settings), bool(summarise), callback)
    warn(defects, str(src))
    result: dict[str, Any] = json.loads(summary)
    return result


def inspect(path: Path, *, progress: Progress = None, **settings: Unpack[InspectSettings]) -> dict[str, Any]:
    """Says what is in a mesh file: counts, extent, edge kinds, defects with places, and suggested settings.

    The object that ``osculate inspect --format json`` prints. Settings: ``feature_angle``, ``weld``, ``view``,
    ``input_format``, ``allow_folder`` and ``threads``. Raises what ``read`` raises; does not warn, since the defects
    are what was asked for.
    """
    with reporting(progress) as callback:
        found = _native.inspect(path, texts("inspect", settings), callback)
    result: dict[str, Any] = json.loads(found)
    return result
