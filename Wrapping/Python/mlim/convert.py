"""Converts a volume file of vtkMultiLabelInterfaceMesher for finite-element programs.

    python3 -m mlim.convert volume.vtu volume.msh
    python3 -m mlim.convert volume.vtu volume.inp --surface surface.vtp
"""

from __future__ import annotations

import argparse
import sys

from vtkmodules.vtkIOXML import vtkXMLPolyDataReader, vtkXMLUnstructuredGridReader

from .exporting import write_volume


def _read(reader, path):
    if not reader.CanReadFile(path):
        raise OSError(f"{path} is missing or is not a file of this kind")
    reader.SetFileName(path)
    reader.Update()
    return reader.GetOutput()


def main(words: list[str] | None = None) -> int:
    parser = argparse.ArgumentParser(prog="mlim.convert", description=__doc__.splitlines()[0])
    parser.add_argument("volume", help="the volume, a .vtu file")
    parser.add_argument("out", help="a .msh file (Gmsh) or an .inp file (Abaqus)")
    parser.add_argument("--surface", help="its surface, a .vtp file: borders of regions as groups as well")
    given = parser.parse_args(words)
    try:
        volume = _read(vtkXMLUnstructuredGridReader(), given.volume)
        surface = _read(vtkXMLPolyDataReader(), given.surface) if given.surface else None
        write_volume(volume, given.out, surface)
    except (ImportError, OSError, ValueError) as error:
        print(f"mlim.convert: {error}", file=sys.stderr)
        return 1
    return 0


if __name__ == "__main__":
    sys.exit(main())
