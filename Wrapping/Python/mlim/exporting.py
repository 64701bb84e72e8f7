"""Volumes as files for finite-element programs, with the labels as groups."""

from __future__ import annotations

import os
import re
from pathlib import Path
from typing import TYPE_CHECKING

import numpy as np
from vtkmodules.util.numpy_support import vtk_to_numpy
from vtkmodules.vtkIOXML import vtkXMLUnstructuredGridWriter

if TYPE_CHECKING:
    from vtkmodules.vtkCommonDataModel import vtkPolyData, vtkUnstructuredGrid

_FORMATS = {".msh": "gmsh22", ".inp": "abaqus"}


def write_volume(
    volume: vtkUnstructuredGrid,
    path: str | os.PathLike[str],
    surface: vtkPolyData | None = None,
) -> None:
    """Writes the volume that mlim.mesh made, in the format that the path's suffix names.

    .vtu: VTK's own, with all arrays. .msh: Gmsh 2.2, each label a physical volume whose tag is the
    label's id. .inp: Abaqus, each label an element set. Groups have the labels' names, or
    label_<id>.
    surface: the surface that came with the volume, caps included; each pair of labels that meet
        is a group too, named after both: a physical surface of triangles (.msh) or a node set
        (.inp). Not for .vtu.

    .msh and .inp need meshio (python3-meshio); without it ImportError. ValueError: another suffix,
    or a surface that is not the volume's. OSError: the file cannot be written.
    """
    path = Path(path)
    suffix = path.suffix.lower()
    if suffix == ".vtu":
        if surface is not None:
            raise ValueError("a .vtu file holds the volume alone; write the surface as .vtp")
        _write_vtu(volume, path)
    elif suffix in _FORMATS:
        _write_groups(volume, surface, path, _FORMATS[suffix])
    else:
        raise ValueError(f"{path.name}: the suffix has to be .vtu, .msh or .inp")


def _write_vtu(volume: vtkUnstructuredGrid, path: Path) -> None:
    writer = vtkXMLUnstructuredGridWriter()
    writer.SetFileName(str(path))
    writer.SetInputData(volume)
    if writer.Write() != 1:
        raise OSError(f"{path} cannot be written")


def _names(volume: vtkUnstructuredGrid) -> dict[int, str]:
    """The labels' names by id, in words that every format takes, each only once."""
    arrays = volume.GetFieldData()
    ids, names = arrays.GetArray("LabelIds"), arrays.GetAbstractArray("LabelNames")
    count = ids.GetNumberOfValues() if ids is not None and names is not None else 0
    known = {ids.GetVariantValue(k).ToInt(): names.GetValue(k) for k in range(count)}
    labels = np.unique(vtk_to_numpy(volume.GetCellData().GetArray("Label"))).tolist()
    result: dict[int, str] = {}
    for label in sorted({*known, *labels}):
        name = re.sub(r"[^A-Za-z0-9_]+", "_", known.get(label, "")).strip("_")
        # Abaqus wants a letter first.
        name = name if re.match(r"[A-Za-z]", name) else f"label_{name or label}"
        result[label] = f"{name}_{label}" if name.lower() in _lower(result) else name
    return result


def _lower(names: dict[int, str]) -> set[str]:
    return {name.lower() for name in names.values()}


def _write_groups(
    volume: vtkUnstructuredGrid, surface: vtkPolyData | None, path: Path, file_format: str
) -> None:
    import meshio

    names = _names(volume)
    points = vtk_to_numpy(volume.GetPoints().GetData()).astype(float)
    cells = vtk_to_numpy(volume.GetCells().GetConnectivityArray()).reshape(-1, 4)
    labels = vtk_to_numpy(volume.GetCellData().GetArray("Label"))
    regions = {label: cells[labels == label] for label in np.unique(labels).tolist()}
    borders = {} if surface is None else _borders(surface, points, names)
    make = _abaqus_mesh if file_format == "abaqus" else _gmsh_mesh
    options = {} if file_format == "abaqus" else {"binary": True}
    mesh = make(meshio, points, {label: (names[label], c) for label, c in regions.items()}, borders)
    meshio.write(path, mesh, file_format=file_format, **options)


def _abaqus_mesh(meshio, points, regions, borders):
    # Triangles would be elements of their own in Abaqus: their points are what loads need.
    count = len(regions)
    sets = {
        name: [np.arange(len(cells)) if g == k else np.array([], int) for g in range(count)]
        for k, (name, cells) in enumerate(regions.values())
    }
    return meshio.Mesh(
        points,
        [("tetra", cells) for _, cells in regions.values()],
        cell_sets=sets,
        point_sets={name: np.unique(triangles) for name, triangles in borders.items()},
    )


def _gmsh_mesh(meshio, points, regions, borders):
    # The tag of a region is its label's id; tags are above 0.
    free = 1 + max([0, *regions])
    groups = []
    for label, (name, cells) in regions.items():
        groups.append((name, 3, "tetra", cells, label if label > 0 else free))
        free += label <= 0
    for name, triangles in borders.items():
        groups.append((name, 2, "triangle", triangles, free))
        free += 1
    data = [np.full(len(cells), tag) for _, _, _, cells, tag in groups]
    return meshio.Mesh(
        points,
        [(kind, cells) for _, _, kind, cells, _ in groups],
        cell_data={"gmsh:physical": data, "gmsh:geometrical": data},
        field_data={name: np.array([tag, dimension]) for name, dimension, _, _, tag in groups},
    )


def _borders(surface, points, names):
    """{name: triangles} of the pairs of labels that the surface separates."""
    own = vtk_to_numpy(surface.GetPoints().GetData())
    if len(own) > len(points) or not np.array_equal(own, points[: len(own)]):
        raise ValueError("the surface is not the volume's, or lacks its caps")
    polys = surface.GetPolys()
    triangles = vtk_to_numpy(polys.GetConnectivityArray()).reshape(-1, 3)
    pairs = vtk_to_numpy(surface.GetCellData().GetArray("BoundaryLabels"))
    pairs = pairs[len(pairs) - len(triangles) :]
    borders = {}
    for pair in np.unique(pairs, axis=0).tolist():
        name = "_to_".join(names.get(label, f"label_{label}") for label in pair)
        borders[name] = triangles[(pairs == pair).all(axis=1)]
    return borders
