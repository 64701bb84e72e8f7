"""Pictures of the eight spheres against committed ones, by VTK's image test.

    python3 Testing/Python/TestPictures.py --renew     writes the baselines anew: look at them

Pictures are drawn without the triangles' edges, and a tolerance lies well above what another density
of the mesh makes, and well below what a wrong colour, a hole or a missing curve makes: both are
tested here too. A mesh that is a little different passes.
"""

import os
import subprocess
import sys
import tempfile
import unittest
from pathlib import Path

import numpy as np
from vtkmodules.util.numpy_support import numpy_to_vtk, vtk_to_numpy
from vtkmodules.vtkCommonDataModel import vtkCellArray, vtkPolyData
from vtkmodules.vtkIOImage import vtkPNGReader
from vtkmodules.vtkImagingCore import vtkImageDifference

import mlim

SKIPPED = 77
HERE = Path(__file__).resolve().parent
EXAMPLES = HERE.parents[1] / "ExampleData"
BASELINES = HERE / "Baselines"
WIDTH = "480"
# What a pixel may differ, of 255, after a shift by up to one pixel and averaging.
PIXEL_TOLERANCE = 16
# Drawing script, options and tolerance of each picture, the latter in vtkImageDifference's unit: the
# sum, over pixels and colours, of what exceeds PIXEL_TOLERANCE, as a part of 255. Balls stand elsewhere on a curve when sizes change, so theirs is large.
PICTURES = {
    "spheres": ("render.py", ["--view", "whole", "--no-edges"], 40.0),
    "cutaway": ("render.py", ["--view", "cutaway", "--no-edges"], 40.0),
    "curves": ("network.py", ["--view", "curves"], 8.0),
    "balls": ("network.py", ["--view", "balls"], 700.0),
}


class Stages:
    """Surface, curves and balls of the spheres."""

    def __init__(self, size=0.0):
        image = mlim.read(EXAMPLES / "spheres.vti")
        self.curves = mlim.curves(image)
        self.balls = mlim.balls(self.curves, edge_size=size, facet_distance=size / 8)
        self.surface = mlim.mesh(image, facet_size=size, balls=self.balls)

    def draw(self, name, folder):
        script, options, _ = PICTURES[name]
        folder = Path(folder)
        paths = []
        for part in ("surface",) if script == "render.py" else ("curves", "balls"):
            paths.append(folder / f"{part}.vtp")
            mlim.write(getattr(self, part), paths[-1])
        picture = folder / f"{name}.png"
        words = [sys.executable, EXAMPLES / script, *paths, picture, "--width", WIDTH, *options]
        subprocess.run([str(word) for word in words], check=True, timeout=120)
        return picture


def difference(first, second):
    """VTK's measure."""
    readers = [vtkPNGReader(), vtkPNGReader()]
    for reader, path in zip(readers, (first, second)):
        reader.SetFileName(str(path))
        reader.Update()
    sizes = [reader.GetOutput().GetDimensions() for reader in readers]
    if sizes[0] != sizes[1]:
        raise AssertionError(f"{first} and {second} have the sizes {sizes}")
    measure = vtkImageDifference()
    measure.SetInputConnection(readers[0].GetOutputPort())
    measure.SetImageConnection(readers[1].GetOutputPort())
    measure.SetThreshold(PIXEL_TOLERANCE)
    measure.Update()
    return measure.GetThresholdedError()


def copy_of(data):
    copy = vtkPolyData()
    copy.DeepCopy(data)
    return copy


def without_cells(cells, is_left_out):
    """The cells whose index is not left out."""
    offsets = vtk_to_numpy(cells.GetOffsetsArray())
    ids = vtk_to_numpy(cells.GetConnectivityArray())
    result = vtkCellArray()
    for index, (begin, end) in enumerate(zip(offsets, offsets[1:])):
        if not is_left_out[index]:
            result.InsertNextCell(end - begin, ids[begin:end].tolist())
    return result


def without_triangles(surface, is_left_out):
    result = copy_of(surface)
    result.SetPolys(without_cells(surface.GetPolys(), is_left_out))
    first = surface.GetNumberOfVerts() + surface.GetNumberOfLines()
    keep = np.append(np.ones(first, bool), ~is_left_out)
    labels = vtk_to_numpy(surface.GetCellData().GetArray("BoundaryLabels"))[keep]
    array = numpy_to_vtk(np.ascontiguousarray(labels), deep=True)
    array.SetName("BoundaryLabels")
    result.GetCellData().Initialize()
    result.GetCellData().AddArray(array)
    return result


class TestPictures(unittest.TestCase):
    @classmethod
    def setUpClass(cls):
        cls.stages = Stages()

    def setUp(self):
        folder = tempfile.TemporaryDirectory()
        self.addCleanup(folder.cleanup)
        self.folder = folder.name

    def difference_of(self, name, stages):
        return difference(BASELINES / f"{name}.png", stages.draw(name, self.folder))

    def check_seen(self, name, stages):
        self.assertGreater(self.difference_of(name, stages), PICTURES[name][2], name)

    def changed(self, **parts):
        stages = object.__new__(Stages)
        vars(stages).update(vars(self.stages), **parts)
        return stages

    def test_baselines(self):
        for name, (_, _, tolerance) in PICTURES.items():
            found = self.difference_of(name, self.stages)
            self.assertLess(found, tolerance, f"{name}; see the top of this file")

    def test_another_density_passes(self):
        other = Stages(1.1 * self.stages.surface.GetFieldData().GetArray("FacetSize").GetValue(0))
        for name, (_, _, tolerance) in PICTURES.items():
            self.assertLess(self.difference_of(name, other), tolerance, name)

    def test_wrong_colours_are_seen(self):
        surface = copy_of(self.stages.surface)
        labels = vtk_to_numpy(surface.GetCellData().GetArray("BoundaryLabels"))
        labels[labels == 7], labels[labels == 8] = 8, 7
        for name in ("spheres", "cutaway"):
            self.check_seen(name, self.changed(surface=surface))

    def test_a_hole_is_seen(self):
        surface = self.stages.surface
        points = vtk_to_numpy(surface.GetPoints().GetData())
        triangles = vtk_to_numpy(surface.GetPolys().GetConnectivityArray()).reshape(-1, 3)
        centres = points[triangles].mean(axis=1)
        nearest = centres[np.argmax(centres @ (0.56, -0.72, 0.41))]  # to the viewer
        distances = np.linalg.norm(centres - nearest, axis=1)
        hole = np.zeros(len(triangles), bool)
        hole[np.argsort(distances)[:6]] = True
        self.check_seen("spheres", self.changed(surface=without_triangles(surface, hole)))

    def test_missing_curves_are_seen(self):
        surface = copy_of(self.stages.surface)
        labels = vtk_to_numpy(surface.GetCellData().GetArray("BoundaryLabels"))
        lines = surface.GetNumberOfLines()
        surface.SetLines(vtkCellArray())
        first = surface.GetNumberOfVerts()
        kept = numpy_to_vtk(np.delete(labels, np.s_[first : first + lines], axis=0), deep=True)
        kept.SetName("BoundaryLabels")
        surface.GetCellData().Initialize()
        surface.GetCellData().AddArray(kept)
        for name in ("spheres", "cutaway"):
            self.check_seen(name, self.changed(surface=surface))

        curves = copy_of(self.stages.curves)
        left_out = np.zeros(curves.GetNumberOfLines(), bool)
        offsets = vtk_to_numpy(curves.GetLines().GetOffsetsArray())
        left_out[np.argsort(np.diff(offsets))[-3]] = True
        curves.SetLines(without_cells(curves.GetLines(), left_out))
        self.check_seen("curves", self.changed(curves=curves))

    def test_other_balls_are_seen(self):
        balls = copy_of(self.stages.balls)
        vtk_to_numpy(balls.GetPointData().GetArray("Radius"))[:] *= 1.3
        self.check_seen("balls", self.changed(balls=balls))


def renew():
    BASELINES.mkdir(exist_ok=True)
    stages = Stages()
    with tempfile.TemporaryDirectory() as folder:
        for name in PICTURES:
            (BASELINES / f"{name}.png").write_bytes(stages.draw(name, folder).read_bytes())


if __name__ == "__main__":
    if not os.environ.get("DISPLAY"):
        print("skipped: no display")
        sys.exit(SKIPPED)
    if "--renew" in sys.argv:
        renew()
    else:
        unittest.main()
