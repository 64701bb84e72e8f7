#!/usr/bin/env python3
"""A pipeline of the filters with VTK's own reader, filters and writers.

    PYTHONPATH=<where mlim is> python3 Examples/Python/mesh_labels.py IMAGE.vti FOLDER [FACET_SIZE]

Writes surface.vtp, curves.vtp, balls.vtp, and each region's closed boundary: region_<id>.stl.
"""

import sys
from pathlib import Path

from vtkmodules.vtkCommonDataModel import vtkDataObject
from vtkmodules.vtkFiltersCore import vtkPolyDataNormals, vtkThreshold
from vtkmodules.vtkFiltersGeometry import vtkGeometryFilter
from vtkmodules.vtkIOGeometry import vtkSTLWriter
from vtkmodules.vtkIOXML import vtkXMLImageDataReader, vtkXMLPolyDataWriter

import mlim


def write(writer, port, path):
    writer.SetInputConnection(port)
    writer.SetFileName(str(path))
    if not writer.Write():
        raise OSError(f"cannot write {path}")


def boundary_of(surface, region):
    """The triangles with the region on either side, all normals outwards."""
    choose = vtkThreshold()
    choose.SetInputConnection(surface)
    choose.SetInputArrayToProcess(0, 0, 0, vtkDataObject.CELL, "BoundaryLabels")
    choose.SetComponentModeToUseAny()
    choose.SetThresholdFunction(vtkThreshold.THRESHOLD_BETWEEN)
    choose.SetLowerThreshold(region)
    choose.SetUpperThreshold(region)
    triangles = vtkGeometryFilter()
    triangles.SetInputConnection(choose.GetOutputPort())
    normals = vtkPolyDataNormals()
    normals.SetInputConnection(triangles.GetOutputPort())
    normals.AutoOrientNormalsOn()
    normals.SplittingOff()
    return normals


def main():
    if len(sys.argv) not in (3, 4):
        sys.exit(__doc__)
    folder = Path(sys.argv[2])
    reader = vtkXMLImageDataReader()
    reader.SetFileName(sys.argv[1])

    curves = mlim.vtkMultiLabelCurveExtractor()
    curves.SetInputConnection(reader.GetOutputPort())
    balls = mlim.vtkMultiLabelCurveProtector()
    balls.SetInputConnection(curves.GetOutputPort())

    # Without the balls the mesher makes them itself, with the same result.
    mesher = mlim.vtkMultiLabelInterfaceMesher()
    mesher.SetInputConnection(reader.GetOutputPort())
    mesher.SetBallsConnection(balls.GetOutputPort())
    if len(sys.argv) == 4:
        mesher.SetFacetSize(float(sys.argv[3]))

    write(vtkXMLPolyDataWriter(), mesher.GetOutputPort(), folder / "surface.vtp")
    write(vtkXMLPolyDataWriter(), curves.GetOutputPort(), folder / "curves.vtp")
    write(vtkXMLPolyDataWriter(), balls.GetOutputPort(), folder / "balls.vtp")

    ids = mesher.GetOutput().GetFieldData().GetArray("LabelIds")
    for entry in range(ids.GetNumberOfValues()):
        region = int(ids.GetComponent(entry, 0))
        if region != 0:  # the background
            boundary = boundary_of(mesher.GetOutputPort(), region)
            write(vtkSTLWriter(), boundary.GetOutputPort(), folder / f"region_{region}.stl")


if __name__ == "__main__":
    main()
