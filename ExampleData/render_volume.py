#!/usr/bin/env python3
"""Renders volume meshes cut open, side by side.

    python3 ExampleData/render_volume.py PICTURE.png VOLUME.vtu [VOLUME.vtu ...]
        [--at SHARE] [--normal X Y Z] [--width PIXELS] [--azimuth DEGREES] [--elevation DEGREES]

Whole tetrahedra are left out whose centre lies beyond the plane, so that the others are seen as they
are. Each region has a colour; the faces on its surface are lighter than those that the cut lays
bare.
"""

import argparse

import numpy as np
from vtkmodules.util.numpy_support import numpy_to_vtk, vtk_to_numpy
from vtkmodules.vtkCommonCore import vtkPoints
from vtkmodules.vtkCommonDataModel import vtkCellArray, vtkPolyData
from vtkmodules.vtkIOXML import vtkXMLUnstructuredGridReader
from vtkmodules.vtkRenderingCore import vtkActor, vtkPolyDataMapper, vtkRenderer

from render import (
    PALETTE,
    add_lights,
    place_camera,
    view_direction,
    write_picture,
)

FACES = np.array([[1, 2, 3], [0, 3, 2], [0, 1, 3], [0, 2, 1]])
EDGE_COLOUR = (0.13, 0.15, 0.19)
# How far faces on a surface are blended with white.
SURFACE_TINT = 0.45


class Volume:
    """Points, tetrahedra and labels of a file, and which label has which colour."""

    def __init__(self, path):
        reader = vtkXMLUnstructuredGridReader()
        reader.SetFileName(str(path))
        reader.Update()
        grid = reader.GetOutput()
        array = grid.GetCellData().GetArray("Label")
        if array is None or grid.GetNumberOfCells() == 0:
            raise SystemExit(f"{path} holds no volume mesh")
        self.points = vtk_to_numpy(grid.GetPoints().GetData()).astype(float)
        self.cells = vtk_to_numpy(grid.GetCells().GetConnectivityArray()).reshape(-1, 4)
        self.labels = vtk_to_numpy(array)
        self.order = np.unique(self.labels)

    def colours(self, labels):
        return PALETTE[np.searchsorted(self.order, labels) % len(PALETTE)]

    def neighbours(self):
        """(cells, 4): the cell beyond each face, or -1."""
        faces = np.sort(self.cells[:, FACES].reshape(-1, 3), axis=1)
        order = np.lexsort(faces.T)
        same = (faces[order[1:]] == faces[order[:-1]]).all(axis=1)
        result = np.full(len(faces), -1)
        result[order[1:][same]] = order[:-1][same] // 4
        result[order[:-1][same]] = order[1:][same] // 4
        return result.reshape(-1, 4)


def visible_faces(volume, is_kept):
    """Triangles round the kept cells, and their colours."""
    beyond = volume.neighbours()
    is_inner = (beyond >= 0) & is_kept[beyond]
    cell, face = np.nonzero(is_kept[:, None] & ~is_inner)
    triangles = volume.cells[cell[:, None], FACES[face]]
    colours = volume.colours(volume.labels[cell])
    others = beyond[cell, face]
    on_surface = (others < 0) | (volume.labels[others] != volume.labels[cell])
    colours[on_surface] += SURFACE_TINT * (1 - colours[on_surface])
    return triangles, colours


def make_actor(volume, triangles, colours, edge_width):
    polydata = vtkPolyData()
    points = vtkPoints()
    points.SetData(numpy_to_vtk(volume.points, deep=True))
    polydata.SetPoints(points)
    cells = vtkCellArray()
    connectivity = numpy_to_vtk(triangles.astype(np.int64).ravel(), deep=True)
    offsets = numpy_to_vtk(np.arange(0, triangles.size + 1, 3, dtype=np.int64), deep=True)
    cells.SetData(offsets, connectivity)
    polydata.SetPolys(cells)
    array = numpy_to_vtk((255 * colours).round().astype(np.uint8), deep=True)
    polydata.GetCellData().SetScalars(array)
    mapper = vtkPolyDataMapper()
    mapper.SetInputData(polydata)
    actor = vtkActor()
    actor.SetMapper(mapper)
    look = actor.GetProperty()
    look.SetInterpolationToFlat()
    look.SetAmbient(0.34)
    look.SetDiffuse(0.72)
    look.EdgeVisibilityOn()
    look.SetEdgeColor(*EDGE_COLOUR)
    look.SetLineWidth(edge_width)
    return actor


def make_renderer(path, options, normal, toward_viewer, viewport):
    volume = Volume(path)
    centres = volume.points[volume.cells].mean(axis=1)
    depths = centres @ normal
    plane = np.quantile(depths, options.at)
    triangles, colours = visible_faces(volume, depths <= plane)
    renderer = vtkRenderer()
    renderer.SetBackground(1, 1, 1)
    renderer.SetViewport(*viewport)
    renderer.AddActor(make_actor(volume, triangles, colours, options.edge_width))
    add_lights(renderer)
    place_camera(renderer, volume.points[np.unique(triangles)], toward_viewer)
    return renderer


def main():
    parser = argparse.ArgumentParser(description=__doc__.splitlines()[0])
    parser.add_argument("picture")
    parser.add_argument("volumes", nargs="+")
    parser.add_argument("--at", type=float, default=0.55, help="share of the cells that are kept")
    parser.add_argument(
        "--normal", type=float, nargs=3, default=(0.55, -0.8, 0.25), help="of the plane"
    )
    parser.add_argument("--edge-width", type=float, default=1.2, help="pixels")
    parser.add_argument("--width", type=int, default=1600, help="pixels")
    parser.add_argument("--azimuth", type=float, default=-52, help="degrees from x towards y")
    parser.add_argument("--elevation", type=float, default=24, help="degrees above the xy plane")
    options = parser.parse_args()
    toward_viewer = view_direction(options.azimuth, options.elevation)
    normal = np.array(options.normal) / np.linalg.norm(options.normal)
    count = len(options.volumes)
    renderers = [
        make_renderer(path, options, normal, toward_viewer, (k / count, 0, (k + 1) / count, 1))
        for k, path in enumerate(options.volumes)
    ]
    write_picture(renderers, (options.width, options.width // count), options.picture)


if __name__ == "__main__":
    main()
