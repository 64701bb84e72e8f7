"""What a mesh says about itself, as text."""

from __future__ import annotations

from typing import TYPE_CHECKING

if TYPE_CHECKING:
    from vtkmodules.vtkCommonDataModel import vtkPolyData, vtkUnstructuredGrid

_COUNTS = (
    ("vertices", "VertexCount"),
    ("triangles", "TriangleCount"),
    ("patches", "PatchCount"),
    ("curves", "CurveCount"),
    ("junctions", "JunctionCount"),
    ("protecting balls", "BallCount"),
    ("balls covered by others", "HiddenBallCount"),
    ("cells with a mended label", "RelabeledCellCount"),
    ("contacts", "ContactCount"),
    ("edges of contacts", "ContactEdgeCount"),
    ("junction edges off the curves", "OffCurveEdgeCount"),
    ("curve edges lost", "LostCurveEdgeCount"),
)
_LENGTHS = (
    ("facet size", "FacetSize"),
    ("facet distance", "FacetDistance"),
    ("edge size", "EdgeSize"),
)
_QUALITY = (
    ("largest radius-edge ratio", "MaxRadiusEdgeRatio"),
    ("largest beside curves", "MaxBallRadiusEdgeRatio"),
    ("mean radius-edge ratio", "MeanRadiusEdgeRatio"),
    ("smallest angle, degrees", "MinAngle"),
    ("smallest dihedral angle at curves", "MinDihedralAngle"),
)
_UNDONE = (
    ("crossings", "UnresolvedCrossingCount"),
    ("patches", "UnresolvedPatchCount"),
    ("size", "UnresolvedSizeCount"),
    ("distance", "UnresolvedDistanceCount"),
    ("ratio", "UnresolvedRatioCount"),
    ("ratio at mended labels", "RelabeledRatioCount"),
    ("ratio beside curves", "UnresolvedBallRatioCount"),
)
_TIMES = (
    ("indicators", "TimeIndicators"),
    ("field", "TimeField"),
    ("curves", "TimeCurves"),
    ("balls", "TimeBalls"),
    ("surface", "TimeSurface"),
    ("certificate", "TimeCertificate"),
)


_VOLUME_COUNTS = (
    ("vertices", "VertexCount"),
    ("of them on the surface", "SurfaceVertexCount"),
    ("tetrahedra", "CellCount"),
)
_VOLUME_LENGTHS = (("cell size", "CellSize"),)
_VOLUME_QUALITY = (
    ("smallest dihedral angle, degrees", "MinDihedralAngle"),
    ("largest", "MaxDihedralAngle"),
    ("largest radius-edge ratio", "MaxRadiusEdgeRatio"),
)
_VOLUME_UNDONE = (
    ("size", "UnresolvedSizeCount"),
    ("ratio", "UnresolvedRatioCount"),
    ("slivers", "UnresolvedSliverCount"),
    ("places off the box", "UnresolvedBoxCount"),
)


# Values of the arrays NodeType and DiskFailureTypes; the image's box adds to them.
_NODE_TYPES = {2: "on an interface", 3: "on a curve", 4: "at a junction or contact"}
_NODE_ON_BOX = 10
# Places of vertices that the report lists.
_MOST_PLACES = 20


def report(mesh: vtkPolyData | vtkUnstructuredGrid) -> str:
    """Counts, quality, certificate and times of a surface that mlim.mesh or the filter made, or of a
    volume.

    Several lines without a newline at the end. Raises ValueError for other data.
    """
    arrays = mesh.GetFieldData()

    def value(name: str) -> float:
        array = arrays.GetArray(name)
        if array is None or array.GetNumberOfValues() < 1:
            raise ValueError(f"there is no field data array {name}: not a finished mesh")
        return array.GetVariantValue(0).ToDouble()

    def rows(entries, form: str) -> list[str]:
        return [f"  {title:<36}{value(name):{form}}" for title, name in entries]

    def undone_of(entries) -> str:
        undone = [f"{value(n):.0f} {t}" for t, n in entries if value(n) > 0]
        if value("VertexLimitReached"):
            undone.append("stopped at the vertex limit")
        return ", ".join(undone) or "none"

    if arrays.GetArray("CellCount") is not None:
        lines = ["Volume", *rows(_VOLUME_COUNTS, "14,.0f"), *rows(_VOLUME_LENGTHS, "14.6g")]
        lines += ["Quality", *rows(_VOLUME_QUALITY, "14.3f")]
        lines += [f"  {'tetrahedra left undone':<36}{undone_of(_VOLUME_UNDONE):>14}"]
        lines += ["Seconds", *rows((("volume", "TimeVolume"),), "14.2f")]
        return "\n".join(lines)
    lines = ["Mesh", *rows(_COUNTS, "14,.0f"), *rows(_LENGTHS, "14.6g")]
    lines += ["Quality", *rows(_QUALITY, "14.3f")]
    lines += [f"  {'triangles left undone':<36}{undone_of(_UNDONE):>14}"]
    lines += ["Certificate"]
    lines += [_of("labels in the mesh", value, "LostLabelCount", "CertifiedLabelCount")]
    lines += [_of("components in the mesh", value, "LostComponentCount", "CertifiedComponentCount")]
    lines += [_of("grid crossings near the mesh", value, "FarCrossingCount", "GridCrossingCount")]
    lines += rows(
        (
            ("farthest grid crossing", "MaxCrossingDistance"),
            ("largest relative volume difference", "MaxVolumeDifference"),
        ),
        "14.4g",
    )
    lines += rows((("vertices off the disk condition", "DiskFailureCount"),), "14,.0f")
    lines += _disk_failures(arrays)
    lines += rows((("open edges", "OpenEdgeCount"),), "14,.0f")
    lines += ["Seconds", *rows(_TIMES, "14.2f")]
    lines += [f"  {'in all':<36}{sum(value(name) for _, name in _TIMES):14.2f}"]
    return "\n".join(lines)


def _disk_failures(arrays) -> list[str]:
    """Kind and place of each vertex off the disk condition."""
    places = arrays.GetArray("DiskFailurePoints")
    types = arrays.GetArray("DiskFailureTypes")
    lines = []
    for k in range(min(places.GetNumberOfTuples(), _MOST_PLACES)):
        kind = _NODE_TYPES[types.GetValue(k) % _NODE_ON_BOX]
        where = ", ".join(f"{x:.6g}" for x in places.GetTuple3(k))
        lines += [f"    {kind}, at ({where})"]
    left = places.GetNumberOfTuples() - len(lines)
    return [*lines, f"    and {left:,} more, in DiskFailurePoints"] if left > 0 else lines


def _of(title: str, value, lost: str, total: str) -> str:
    text = f"{value(total) - value(lost):,.0f} of {value(total):,.0f}"
    return f"  {title:<36}{text:>14}"
