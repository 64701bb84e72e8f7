#!/usr/bin/env python3
"""Curves of eight overlapping spheres on 128 points along each axis, against the spheres themselves."""

import sys
import unittest
from pathlib import Path

import numpy as np
from vtkmodules.util.numpy_support import numpy_to_vtk, vtk_to_numpy
from vtkmodules.vtkCommonDataModel import vtkImageData

import mlim

sys.path.insert(0, str(Path(__file__).resolve().parents[2] / "ExampleData"))

from generate import SPHERES, grid_coordinates  # noqa: E402
from naive_field import NaiveField  # noqa: E402

POINTS = 128
SPACING = 2.0 / (POINTS - 1)


def depths(points):
    """How deep points lie in each sphere; the background's 0 comes first."""
    inside = [r - np.linalg.norm(points - np.array(c), axis=-1) for c, r in SPHERES]
    return np.stack([np.zeros(len(points)), *inside])


def make_image():
    image = vtkImageData()
    image.SetDimensions(POINTS, POINTS, POINTS)
    image.SetSpacing(SPACING, SPACING, SPACING)
    image.SetOrigin(-1.0, -1.0, -1.0)
    grid = grid_coordinates((POINTS,) * 3, (SPACING,) * 3, (0.0,) * 3)
    values = depths(np.stack([axis.ravel() for axis in grid], axis=1))
    for k, name in enumerate(["background", *(f"sphere{n + 1}" for n in range(len(SPHERES)))]):
        array = numpy_to_vtk(values[k], deep=True)
        array.SetName(name)
        image.GetPointData().AddArray(array)
    return image


def points_and_sets(curves):
    """For each line the coordinates of its points and its set of ids."""
    data = curves.GetCellData()
    labels = vtk_to_numpy(data.GetArray("LabelSet"))
    first = curves.GetNumberOfVerts()
    coordinates = vtk_to_numpy(curves.GetPoints().GetData())
    lines = curves.GetLines()
    offsets = vtk_to_numpy(lines.GetOffsetsArray())
    connectivity = vtk_to_numpy(lines.GetConnectivityArray())
    for k in range(curves.GetNumberOfLines()):
        ids = connectivity[offsets[k] : offsets[k + 1]]
        row = labels[first + k]
        yield coordinates[ids], row[row >= 0]


def spread(values, ids):
    """Difference of the largest and the smallest value among the labels, at each point."""
    return np.ptp(values[ids], axis=0)


class SpheresCurves(unittest.TestCase):
    @classmethod
    def setUpClass(cls):
        cls.image = make_image()
        cls.lines = list(points_and_sets(mlim.curves(cls.image)))

    def test_there_are_curves_of_every_kind(self):
        with_background = sum(0 in ids for _, ids in self.lines)
        self.assertGreaterEqual(with_background, 12)  # the cube's edges: neighbours that overlap
        self.assertGreater(len(self.lines), with_background)

    def test_points_are_on_the_tie_of_the_interpolants(self):
        field = NaiveField(self.image)
        for points, ids in self.lines:
            values = field.interpolate(field.to_index(points))
            self.assertLess(spread(values, ids).max() / SPACING, 0.02)

    def test_points_are_on_the_exact_circles(self):
        for points, ids in self.lines:
            if 0 in ids:
                self.assertLess(spread(depths(points), ids).max() / SPACING, 0.1)


if __name__ == "__main__":
    unittest.main()
