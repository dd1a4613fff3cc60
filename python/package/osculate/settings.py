"""Settings of every call: keyword arguments, each an option of the command line with underscores for hyphens.

Made from the command line's definitions by python/make_settings.py; names, defaults and help texts are theirs. A
setting that is left out, or None, has its default. Lists may be given as such, or as text separated by commas.
"""

from __future__ import annotations

import os
from collections.abc import Sequence
from typing import Any, Literal, TypedDict, Union

from numpy.typing import NDArray

Path = Union[str, "os.PathLike[str]"]
Vector = Union[tuple[float, float, float], "NDArray[Any]"]


class MeshSettings(TypedDict, total=False):
    """Settings of ``osculate.Mesh``."""

    # Mesh

    #: Angle between face normals above which an edge is a feature, where disks end; degrees, 0 to 180 (180: no
    #: features) (default: 40).
    feature_angle: float | None

    #: Weld vertices up to this far apart, in file units; 0 welds equal positions only (default: 0).
    weld: float | None

    # General

    #: Threads to use, 1 or more; default: one per core. The output does not depend on it.
    threads: int | None


class ReadSettings(TypedDict, total=False):
    """Settings of ``osculate.read``."""

    # Input

    #: Input format, where the content does not tell.
    input_format: Literal["stl", "obj", "ply", "off", "3mf", "gltf"] | None

    #: Also read files in this folder that the input names, such as a glTF's buffers; may be given several times.
    #: Default: only those beside the input and below.
    allow_folder: Union[Path, Sequence[Path]] | None

    # Mesh

    #: Angle between face normals above which an edge is a feature, where disks end; degrees, 0 to 180 (180: no
    #: features) (default: 40).
    feature_angle: float | None

    #: Weld vertices up to this far apart, in file units; 0 welds equal positions only (default: 0).
    weld: float | None

    # General

    #: Threads to use, 1 or more; default: one per core. The output does not depend on it.
    threads: int | None


class AnnotateSettings(TypedDict, total=False):
    """Settings of ``osculate.annotate``."""

    # Estimation

    #: How curvature is estimated (default: auto).
    estimator: Literal["auto", "osculating", "osculating3", "tangent"] | None

    #: Distance in file units up to which the mesh counts (for disks: length of the legs), above 0; or auto: chosen
    #: for every face (default: auto).
    radius: Union[float, Literal["auto"]] | None

    #: The radius in mean edges of the face (F or F:face) or of the whole mesh (F:mesh) instead; above 0, at most
    #: 1000.
    radius_factor: Union[float, str] | None

    #: Diameters of a disk, 3 to 360. auto lays disks only where vertices do not carry a fit, and for
    #: gauss_perimeter (default: 12).
    diameters: int | None

    #: Turn over a disk (curvature times radius, in radians) that still counts as flat, 0 to 1 (default: 0.05).
    class_tolerance: float | None

    # Mesh

    #: Angle between face normals above which an edge is a feature, where disks end; degrees, 0 to 180 (180: no
    #: features) (default: 40).
    feature_angle: float | None

    #: Weld vertices up to this far apart, in file units; 0 welds equal positions only (default: 0).
    weld: float | None

    # Output

    #: Quantities to write, separated by commas: face, class, k_max, k_min, mean, gauss, gauss_perimeter,
    #: shape_index, curvedness, dir_max, dir_min, radius, coverage, method, confidence; or default, all, none
    #: (default: default).
    attributes: Union[str, Sequence[str]] | None

    # General

    #: Threads to use, 1 or more; default: one per core. The output does not depend on it.
    threads: int | None


class EstimateSettings(TypedDict, total=False):
    """Settings of ``Mesh.annotate``."""

    # Estimation

    #: How curvature is estimated (default: auto).
    estimator: Literal["auto", "osculating", "osculating3", "tangent"] | None

    #: Distance in file units up to which the mesh counts (for disks: length of the legs), above 0; or auto: chosen
    #: for every face (default: auto).
    radius: Union[float, Literal["auto"]] | None

    #: The radius in mean edges of the face (F or F:face) or of the whole mesh (F:mesh) instead; above 0, at most
    #: 1000.
    radius_factor: Union[float, str] | None

    #: Diameters of a disk, 3 to 360. auto lays disks only where vertices do not carry a fit, and for
    #: gauss_perimeter (default: 12).
    diameters: int | None

    #: Turn over a disk (curvature times radius, in radians) that still counts as flat, 0 to 1 (default: 0.05).
    class_tolerance: float | None

    # Output

    #: Quantities to write, separated by commas: face, class, k_max, k_min, mean, gauss, gauss_perimeter,
    #: shape_index, curvedness, dir_max, dir_min, radius, coverage, method, confidence; or default, all, none
    #: (default: default).
    attributes: Union[str, Sequence[str]] | None

    # General

    #: Threads to use, 1 or more; default: one per core. The output does not depend on it.
    threads: int | None


class ConvertSettings(TypedDict, total=False):
    """Settings of ``osculate.convert``."""

    # Input

    #: Input format, where the content does not tell.
    input_format: Literal["stl", "obj", "ply", "off", "3mf", "gltf"] | None

    #: Also read files in this folder that the input names, such as a glTF's buffers; may be given several times.
    #: Default: only those beside the input and below.
    allow_folder: Union[Path, Sequence[Path]] | None

    # Estimation

    #: How curvature is estimated (default: auto).
    estimator: Literal["auto", "osculating", "osculating3", "tangent"] | None

    #: Distance in file units up to which the mesh counts (for disks: length of the legs), above 0; or auto: chosen
    #: for every face (default: auto).
    radius: Union[float, Literal["auto"]] | None

    #: The radius in mean edges of the face (F or F:face) or of the whole mesh (F:mesh) instead; above 0, at most
    #: 1000.
    radius_factor: Union[float, str] | None

    #: Diameters of a disk, 3 to 360. auto lays disks only where vertices do not carry a fit, and for
    #: gauss_perimeter (default: 12).
    diameters: int | None

    #: Turn over a disk (curvature times radius, in radians) that still counts as flat, 0 to 1 (default: 0.05).
    class_tolerance: float | None

    # Mesh

    #: Angle between face normals above which an edge is a feature, where disks end; degrees, 0 to 180 (180: no
    #: features) (default: 40).
    feature_angle: float | None

    #: Weld vertices up to this far apart, in file units; 0 welds equal positions only (default: 0).
    weld: float | None

    # Output

    #: The input's up axis; what is written as glTF or drawn is turned so that it becomes +Y. glTF is y always.
    #: Default: z for STL and 3MF, y for others.
    up: Literal["y", "z"] | None

    #: The input's unit; what is written as glTF is scaled to metres, and a report shows numbers with it. glTF is in
    #: metres always. Default: lengths stay as they are.
    unit: Literal["mm", "cm", "m", "in"] | None

    #: Quantities to write, separated by commas: face, class, k_max, k_min, mean, gauss, gauss_perimeter,
    #: shape_index, curvedness, dir_max, dir_min, radius, coverage, method, confidence; or default, all, none
    #: (default: default).
    attributes: Union[str, Sequence[str]] | None

    #: Write only the faces that fulfil a condition, such as class=hyperbolic or "k_max>0.1 and mean=-1:1".
    #: Comparisons, joined by and, of a CSV column with a number in the input's unit (=, !=, <, <=, >, >=), with a
    #: range LOW:HIGH (=, !=), or of class and method with names separated by commas. Values, colours and --edges
    #: stay those of the whole mesh.
    select: str | None

    #: Quantity that the colours show (default: mean).
    color_by: Literal[
        "mean",
        "gauss",
        "k_max",
        "k_min",
        "gauss_perimeter",
        "shape_index",
        "curvedness",
        "class",
        "coverage",
        "confidence",
        "none",
    ] | None

    #: Colours; default: blue-red for signed quantities, viridis for others, one colour per class.
    colormap: Literal[
        "blue-red",
        "purple-orange",
        "purple-green",
        "brown-green",
        "viridis",
        "cividis",
        "magma",
        "inferno",
        "plasma",
        "turbo",
        "greys",
    ] | None

    #: Values of the first and last colour, in the quantity's unit in the input; auto takes the 95th percentile of
    #: the magnitudes. Of several variants it is the first's (default: auto).
    range: Union[tuple[float, float], str] | None

    #: Quantities between whose colours a viewer of a glTF file can choose (KHR_materials_variants), separated by
    #: commas: mean, gauss, k_max, k_min, gauss_perimeter, shape_index, curvedness, class, coverage, confidence;
    #: --color-by is shown first where it is among them, otherwise the first is.
    variants: Union[str, Sequence[str]] | None

    #: How glTF carries the colours: a palette texture (right everywhere), vertex colours in linear light (by the
    #: specification), vertex colours in sRGB (for MeshLab), or not at all (default: texture).
    color: Literal["texture", "vertex", "vertex-srgb", "none"] | None

    #: How glTF attaches values to faces: vertices of its own for every face with values as attributes (right in
    #: every client), or vertices shared as in the input and values in an extension of the primitive (under half the
    #: size, without colours, for readers that know it) (default: faces).
    layout: Literal["faces", "indexed"] | None

    #: Also write values of vertices: the mean of the faces around, by area. glTF: attributes ..._VERTEX; PLY:
    #: vertex quality and properties; NPZ: arrays vertex_...
    vertex_values: bool | None

    #: Also write the values of a glTF file as a table (EXT_mesh_features, EXT_structural_metadata), for CesiumJS
    #: and its kin; some 50 bytes more for each face.
    metadata: bool | None

    #: Compress what is added to a glTF file, for delivery over the web (EXT_meshopt_compression). Clients then
    #: lose: opening the file at all where they do not know the extension (MeshLab, Blender, trimesh, VTK and others
    #: refuse it); positions to less than 1/65536 of the mesh's size (those of a glTF input stay exact); curvatures
    #: and radii beyond 16 significant bits; directions, shares and shape index beyond 1/32768 (default: none).
    compress: Literal["none", "meshopt"] | None

    #: Replace attributes of a glTF input that have one of the names above but come from elsewhere; without it they
    #: stay and Osculate's are left out.
    force: bool | None

    #: With --edges: also the silhouette for this direction from the viewer to the mesh, in the input's axes.
    view: Vector | None

    # Estimation

    #: Take the values that a glTF input carries from an earlier run instead of estimating them.
    reuse: bool | None

    # Output

    #: Output format, where the extension does not tell.
    format: Literal["glb", "gltf", "ply", "csv", "npz"] | None

    #: Also write a picture of the colour scales (.png or .svg).
    legend: Path | None

    #: Also write the boundary, feature and non-manifold edges as glTF lines (.glb).
    edges: Path | None

    #: Fail if the output exists instead of replacing it.
    no_clobber: bool | None

    #: Also write counts, seconds per stage and percentiles of the values, in the input's unit, as JSON. - for
    #: standard output.
    stats: Path | None

    # General

    #: Threads to use, 1 or more; default: one per core. The output does not depend on it.
    threads: int | None


class WriteSettings(TypedDict, total=False):
    """Settings of ``Mesh.write``."""

    # Output

    #: The input's up axis; what is written as glTF or drawn is turned so that it becomes +Y. glTF is y always.
    #: Default: z for STL and 3MF, y for others.
    up: Literal["y", "z"] | None

    #: The input's unit; what is written as glTF is scaled to metres, and a report shows numbers with it. glTF is in
    #: metres always. Default: lengths stay as they are.
    unit: Literal["mm", "cm", "m", "in"] | None

    #: Quantities to write, separated by commas: face, class, k_max, k_min, mean, gauss, gauss_perimeter,
    #: shape_index, curvedness, dir_max, dir_min, radius, coverage, method, confidence; or default, all, none
    #: (default: default).
    attributes: Union[str, Sequence[str]] | None

    #: Write only the faces that fulfil a condition, such as class=hyperbolic or "k_max>0.1 and mean=-1:1".
    #: Comparisons, joined by and, of a CSV column with a number in the input's unit (=, !=, <, <=, >, >=), with a
    #: range LOW:HIGH (=, !=), or of class and method with names separated by commas. Values, colours and --edges
    #: stay those of the whole mesh.
    select: str | None

    #: Quantity that the colours show (default: mean).
    color_by: Literal[
        "mean",
        "gauss",
        "k_max",
        "k_min",
        "gauss_perimeter",
        "shape_index",
        "curvedness",
        "class",
        "coverage",
        "confidence",
        "none",
    ] | None

    #: Colours; default: blue-red for signed quantities, viridis for others, one colour per class.
    colormap: Literal[
        "blue-red",
        "purple-orange",
        "purple-green",
        "brown-green",
        "viridis",
        "cividis",
        "magma",
        "inferno",
        "plasma",
        "turbo",
        "greys",
    ] | None

    #: Values of the first and last colour, in the quantity's unit in the input; auto takes the 95th percentile of
    #: the magnitudes. Of several variants it is the first's (default: auto).
    range: Union[tuple[float, float], str] | None

    #: Quantities between whose colours a viewer of a glTF file can choose (KHR_materials_variants), separated by
    #: commas: mean, gauss, k_max, k_min, gauss_perimeter, shape_index, curvedness, class, coverage, confidence;
    #: --color-by is shown first where it is among them, otherwise the first is.
    variants: Union[str, Sequence[str]] | None

    #: How glTF carries the colours: a palette texture (right everywhere), vertex colours in linear light (by the
    #: specification), vertex colours in sRGB (for MeshLab), or not at all (default: texture).
    color: Literal["texture", "vertex", "vertex-srgb", "none"] | None

    #: How glTF attaches values to faces: vertices of its own for every face with values as attributes (right in
    #: every client), or vertices shared as in the input and values in an extension of the primitive (under half the
    #: size, without colours, for readers that know it) (default: faces).
    layout: Literal["faces", "indexed"] | None

    #: Also write values of vertices: the mean of the faces around, by area. glTF: attributes ..._VERTEX; PLY:
    #: vertex quality and properties; NPZ: arrays vertex_...
    vertex_values: bool | None

    #: Also write the values of a glTF file as a table (EXT_mesh_features, EXT_structural_metadata), for CesiumJS
    #: and its kin; some 50 bytes more for each face.
    metadata: bool | None

    #: Compress what is added to a glTF file, for delivery over the web (EXT_meshopt_compression). Clients then
    #: lose: opening the file at all where they do not know the extension (MeshLab, Blender, trimesh, VTK and others
    #: refuse it); positions to less than 1/65536 of the mesh's size (those of a glTF input stay exact); curvatures
    #: and radii beyond 16 significant bits; directions, shares and shape index beyond 1/32768 (default: none).
    compress: Literal["none", "meshopt"] | None

    #: Replace attributes of a glTF input that have one of the names above but come from elsewhere; without it they
    #: stay and Osculate's are left out.
    force: bool | None

    #: With --edges: also the silhouette for this direction from the viewer to the mesh, in the input's axes.
    view: Vector | None

    #: Output format, where the extension does not tell.
    format: Literal["glb", "gltf", "ply", "csv", "npz"] | None

    #: Also write a picture of the colour scales (.png or .svg).
    legend: Path | None

    #: Also write the boundary, feature and non-manifold edges as glTF lines (.glb).
    edges: Path | None

    #: Fail if the output exists instead of replacing it.
    no_clobber: bool | None

    # General

    #: Threads to use, 1 or more; default: one per core. The output does not depend on it.
    threads: int | None


class BatchSettings(TypedDict, total=False):
    """Settings of ``osculate.ray.annotate_dataset``."""

    # Input

    #: Input format, where the content does not tell.
    input_format: Literal["stl", "obj", "ply", "off", "3mf", "gltf"] | None

    #: Also read files in this folder that the input names, such as a glTF's buffers; may be given several times.
    #: Default: only those beside the input and below.
    allow_folder: Union[Path, Sequence[Path]] | None

    #: Format of all outputs (default: glb).
    format: Literal["glb", "gltf", "ply", "csv", "npz"] | None

    #: Name the output of part.stl part.stl.glb instead of part.glb.
    keep_extension: bool | None

    # Estimation

    #: How curvature is estimated (default: auto).
    estimator: Literal["auto", "osculating", "osculating3", "tangent"] | None

    #: Distance in file units up to which the mesh counts (for disks: length of the legs), above 0; or auto: chosen
    #: for every face (default: auto).
    radius: Union[float, Literal["auto"]] | None

    #: The radius in mean edges of the face (F or F:face) or of the whole mesh (F:mesh) instead; above 0, at most
    #: 1000.
    radius_factor: Union[float, str] | None

    #: Diameters of a disk, 3 to 360. auto lays disks only where vertices do not carry a fit, and for
    #: gauss_perimeter (default: 12).
    diameters: int | None

    #: Turn over a disk (curvature times radius, in radians) that still counts as flat, 0 to 1 (default: 0.05).
    class_tolerance: float | None

    # Mesh

    #: Angle between face normals above which an edge is a feature, where disks end; degrees, 0 to 180 (180: no
    #: features) (default: 40).
    feature_angle: float | None

    #: Weld vertices up to this far apart, in file units; 0 welds equal positions only (default: 0).
    weld: float | None

    # Output

    #: The input's up axis; what is written as glTF or drawn is turned so that it becomes +Y. glTF is y always.
    #: Default: z for STL and 3MF, y for others.
    up: Literal["y", "z"] | None

    #: The input's unit; what is written as glTF is scaled to metres, and a report shows numbers with it. glTF is in
    #: metres always. Default: lengths stay as they are.
    unit: Literal["mm", "cm", "m", "in"] | None

    #: Quantities to write, separated by commas: face, class, k_max, k_min, mean, gauss, gauss_perimeter,
    #: shape_index, curvedness, dir_max, dir_min, radius, coverage, method, confidence; or default, all, none
    #: (default: default).
    attributes: Union[str, Sequence[str]] | None

    #: Write only the faces that fulfil a condition, such as class=hyperbolic or "k_max>0.1 and mean=-1:1".
    #: Comparisons, joined by and, of a CSV column with a number in the input's unit (=, !=, <, <=, >, >=), with a
    #: range LOW:HIGH (=, !=), or of class and method with names separated by commas. Values, colours and --edges
    #: stay those of the whole mesh.
    select: str | None

    #: Quantity that the colours show (default: mean).
    color_by: Literal[
        "mean",
        "gauss",
        "k_max",
        "k_min",
        "gauss_perimeter",
        "shape_index",
        "curvedness",
        "class",
        "coverage",
        "confidence",
        "none",
    ] | None

    #: Colours; default: blue-red for signed quantities, viridis for others, one colour per class.
    colormap: Literal[
        "blue-red",
        "purple-orange",
        "purple-green",
        "brown-green",
        "viridis",
        "cividis",
        "magma",
        "inferno",
        "plasma",
        "turbo",
        "greys",
    ] | None

    #: Values of the first and last colour, in the quantity's unit in the input; auto takes the 95th percentile of
    #: the magnitudes. Of several variants it is the first's (default: auto).
    range: Union[tuple[float, float], str] | None

    #: Quantities between whose colours a viewer of a glTF file can choose (KHR_materials_variants), separated by
    #: commas: mean, gauss, k_max, k_min, gauss_perimeter, shape_index, curvedness, class, coverage, confidence;
    #: --color-by is shown first where it is among them, otherwise the first is.
    variants: Union[str, Sequence[str]] | None

    #: How glTF carries the colours: a palette texture (right everywhere), vertex colours in linear light (by the
    #: specification), vertex colours in sRGB (for MeshLab), or not at all (default: texture).
    color: Literal["texture", "vertex", "vertex-srgb", "none"] | None

    #: How glTF attaches values to faces: vertices of its own for every face with values as attributes (right in
    #: every client), or vertices shared as in the input and values in an extension of the primitive (under half the
    #: size, without colours, for readers that know it) (default: faces).
    layout: Literal["faces", "indexed"] | None

    #: Also write values of vertices: the mean of the faces around, by area. glTF: attributes ..._VERTEX; PLY:
    #: vertex quality and properties; NPZ: arrays vertex_...
    vertex_values: bool | None

    #: Also write the values of a glTF file as a table (EXT_mesh_features, EXT_structural_metadata), for CesiumJS
    #: and its kin; some 50 bytes more for each face.
    metadata: bool | None

    #: Compress what is added to a glTF file, for delivery over the web (EXT_meshopt_compression). Clients then
    #: lose: opening the file at all where they do not know the extension (MeshLab, Blender, trimesh, VTK and others
    #: refuse it); positions to less than 1/65536 of the mesh's size (those of a glTF input stay exact); curvatures
    #: and radii beyond 16 significant bits; directions, shares and shape index beyond 1/32768 (default: none).
    compress: Literal["none", "meshopt"] | None

    #: Replace attributes of a glTF input that have one of the names above but come from elsewhere; without it they
    #: stay and Osculate's are left out.
    force: bool | None

    #: With --edges: also the silhouette for this direction from the viewer to the mesh, in the input's axes.
    view: Vector | None

    # Estimation

    #: Take the values that a glTF input carries from an earlier run instead of estimating them.
    reuse: bool | None

    # Output

    #: Also write a picture of the colour scales beside each output, as NAME.legend.png or .svg.
    legend: Literal["png", "svg"] | None

    #: Also write the boundary, feature and non-manifold edges as glTF lines beside each output, as NAME.edges.glb.
    edges: bool | None

    #: Also write counts, seconds per stage and percentiles of the values beside each output, as NAME.stats.json.
    stats: bool | None

    #: Fail where an output exists instead of replacing it.
    no_clobber: bool | None

    # General

    #: Threads to use, 1 or more; default: one per core. The output does not depend on it.
    threads: int | None


class InspectSettings(TypedDict, total=False):
    """Settings of ``osculate.inspect``."""

    # Input

    #: Input format, where the content does not tell.
    input_format: Literal["stl", "obj", "ply", "off", "3mf", "gltf"] | None

    #: Also read files in this folder that the input names, such as a glTF's buffers; may be given several times.
    #: Default: only those beside the input and below.
    allow_folder: Union[Path, Sequence[Path]] | None

    #: Also count the silhouette edges for this direction from the viewer to the mesh, in the input's axes.
    view: Vector | None

    # Mesh

    #: Angle between face normals above which an edge is a feature, where disks end; degrees, 0 to 180 (180: no
    #: features) (default: 40).
    feature_angle: float | None

    #: Weld vertices up to this far apart, in file units; 0 welds equal positions only (default: 0).
    weld: float | None

    # General

    #: Threads to use, 1 or more; default: one per core. The output does not depend on it.
    threads: int | None


class ColorsSettings(TypedDict, total=False):
    """Settings of ``FaceCurvature.color_scale`` and ``FaceCurvature.colors``."""

    # Output

    #: Quantity that the colours show (default: mean).
    color_by: Literal[
        "mean",
        "gauss",
        "k_max",
        "k_min",
        "gauss_perimeter",
        "shape_index",
        "curvedness",
        "class",
        "coverage",
        "confidence",
        "none",
    ] | None

    #: Colours; default: blue-red for signed quantities, viridis for others, one colour per class.
    colormap: Literal[
        "blue-red",
        "purple-orange",
        "purple-green",
        "brown-green",
        "viridis",
        "cividis",
        "magma",
        "inferno",
        "plasma",
        "turbo",
        "greys",
    ] | None

    #: Values of the first and last colour, in the quantity's unit in the input; auto takes the 95th percentile of
    #: the magnitudes. Of several variants it is the first's (default: auto).
    range: Union[tuple[float, float], str] | None


class DiskSettings(TypedDict, total=False):
    """Settings of ``Mesh.disk``."""

    # Place

    #: The face, by its number from 0 in the order of the input.
    face: int | None

    #: Where in the face: shares of the way along its first and its last edge from its first corner, both 0 or more,
    #: their sum at most 1. Default: the barycentre.
    at: tuple[float, float] | None

    #: The point of the mesh nearest to this one, in the input's coordinates; at most a tenth of the mesh's size
    #: away.
    point: Vector | None

    # Estimation

    #: How curvature is estimated (default: auto).
    estimator: Literal["auto", "osculating", "osculating3", "tangent"] | None

    #: Distance in file units up to which the mesh counts (for disks: length of the legs), above 0; or auto: chosen
    #: for every face (default: auto).
    radius: Union[float, Literal["auto"]] | None

    #: The radius in mean edges of the face (F or F:face) or of the whole mesh (F:mesh) instead; above 0, at most
    #: 1000.
    radius_factor: Union[float, str] | None

    #: Diameters of a disk, 3 to 360. auto lays disks only where vertices do not carry a fit, and for
    #: gauss_perimeter (default: 12).
    diameters: int | None

    #: Turn over a disk (curvature times radius, in radians) that still counts as flat, 0 to 1 (default: 0.05).
    class_tolerance: float | None

    # General

    #: Threads to use, 1 or more; default: one per core. The output does not depend on it.
    threads: int | None


class TraceSettings(TypedDict, total=False):
    """Settings of ``Mesh.trace``."""

    # Path

    #: Direction to follow (default: max).
    along: Literal["max", "min"] | None

    #: Most steps, each as long as the disk's radius; 1 to 1000000 (default: 100).
    steps: int | None

    #: Go both ways from each seed.
    both: bool | None

    #: Trace from this many faces spread evenly over the area, instead of from one place.
    seeds: int | None

    # Place

    #: The face, by its number from 0 in the order of the input.
    face: int | None

    #: Where in the face: shares of the way along its first and its last edge from its first corner, both 0 or more,
    #: their sum at most 1. Default: the barycentre.
    at: tuple[float, float] | None

    #: The point of the mesh nearest to this one, in the input's coordinates; at most a tenth of the mesh's size
    #: away.
    point: Vector | None

    # Estimation

    #: How curvature is estimated (default: auto).
    estimator: Literal["auto", "osculating", "osculating3", "tangent"] | None

    #: Distance in file units up to which the mesh counts (for disks: length of the legs), above 0; or auto: chosen
    #: for every face (default: auto).
    radius: Union[float, Literal["auto"]] | None

    #: The radius in mean edges of the face (F or F:face) or of the whole mesh (F:mesh) instead; above 0, at most
    #: 1000.
    radius_factor: Union[float, str] | None

    #: Diameters of a disk, 3 to 360. auto lays disks only where vertices do not carry a fit, and for
    #: gauss_perimeter (default: 12).
    diameters: int | None

    #: Turn over a disk (curvature times radius, in radians) that still counts as flat, 0 to 1 (default: 0.05).
    class_tolerance: float | None

    # General

    #: Threads to use, 1 or more; default: one per core. The output does not depend on it.
    threads: int | None
