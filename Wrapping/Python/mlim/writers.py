"""Polydata to files, by VTK's writers."""

from __future__ import annotations

import importlib
import os
from typing import TYPE_CHECKING

from .running import collect_messages

if TYPE_CHECKING:
    from vtkmodules.vtkCommonDataModel import vtkPolyData

# What a file's name ends in, and the writer: the module and class of VTK.
_WRITERS = {
    ".vtp": ("vtkIOXML", "vtkXMLPolyDataWriter"),
    ".vtk": ("vtkIOLegacy", "vtkPolyDataWriter"),
    ".stl": ("vtkIOGeometry", "vtkSTLWriter"),
    ".ply": ("vtkIOPLY", "vtkPLYWriter"),
    ".obj": ("vtkIOGeometry", "vtkOBJWriter"),
}


def write(data: vtkPolyData, path: str | os.PathLike[str]) -> None:
    """Writes a polydata: .vtp and .vtk with all arrays; .stl, .ply and .obj triangles only.

    Raises ValueError for another kind of file, and OSError with the writer's sentence.
    """
    name = os.fspath(path)
    check_name(name)
    module, class_name = _WRITERS[os.path.splitext(name)[1].lower()]
    writer = getattr(importlib.import_module(f"vtkmodules.{module}"), class_name)()
    errors: list[str] = []
    collect_messages(writer, "ErrorEvent", errors)
    writer.SetInputData(data)
    writer.SetFileName(name)
    if hasattr(writer, "SetFileTypeToBinary"):
        writer.SetFileTypeToBinary()
    if not writer.Write() or errors or not os.path.exists(name):
        raise OSError(f"{name}: {errors[0] if errors else 'cannot be written'}")


def check_name(name: str) -> None:
    """Raises ValueError unless mlim.write knows this kind of file, OSError without its folder."""
    if os.path.splitext(name)[1].lower() not in _WRITERS:
        raise ValueError(f"{name}: meshes are written as {', '.join(_WRITERS)}")
    if not os.path.isdir(os.path.dirname(name) or "."):
        raise FileNotFoundError(f"{name}: there is no such folder")
