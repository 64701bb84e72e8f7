"""The stages in a pipeline and the mesher alone give the same bytes; so do repeated runs, other
numbers of threads, and balls that went through a file."""

import hashlib
import os
import subprocess
import sys
import tempfile
import unittest

import numpy as np
from vtkmodules.util.numpy_support import numpy_to_vtk, vtk_to_numpy
from vtkmodules.vtkCommonCore import vtkSMPTools
from vtkmodules.vtkCommonDataModel import vtkImageData
from vtkmodules.vtkIOXML import vtkXMLPolyDataReader, vtkXMLPolyDataWriter

import mlim
from audit import audit, check

SIZE = 24
# Centres and radii, in voxels, of balls that meet in curves and junctions; the last one leaves the
# box, so that curves on its faces are protected as well.
BALLS = (
    ((8.3, 9.1, 10.2), 5.2),
    ((14.2, 9.7, 10.8), 4.9),
    ((11.4, 14.6, 10.1), 5.0),
    ((19.5, 16.2, 20.3), 6.4),
)
# An origin, a spacing and axes that are not exact in binary: world space and back rounds.
ORIGIN = (-71.3, 0.1, 1234.567)
SPACING = (0.7, 0.9, 1.1)
ANGLE = 0.3
DIRECTION = (
    (np.cos(ANGLE), np.sin(ANGLE), 0.0),
    (np.sin(ANGLE), -np.cos(ANGLE), 0.0),
    (0.0, 0.0, 1.0),
)


def make_image(is_placed=True):
    image = vtkImageData()
    image.SetDimensions(SIZE, SIZE, SIZE)
    if is_placed:
        image.SetExtent(-3, SIZE - 4, 5, SIZE + 4, 0, SIZE - 1)
        image.SetOrigin(ORIGIN)
        image.SetSpacing(SPACING)
        image.SetDirectionMatrix([x for row in DIRECTION for x in row])
    z, y, x = np.indices((SIZE, SIZE, SIZE)).reshape(3, -1)
    functions = [("background", np.zeros(SIZE**3))]
    for n, (center, radius) in enumerate(BALLS):
        squares = sum((a - b) ** 2 for a, b in zip((x, y, z), center))
        functions.append((f"ball {n}", radius - np.sqrt(squares)))
    for name, values in functions:
        array = numpy_to_vtk(values.astype(np.float32), deep=True)
        array.SetName(name)
        image.GetPointData().AddArray(array)
    return image


def run_stages(image, edge_size=0.0, facet_distance=0.0, ball_radius_scale=1.0):
    """Extractor and protector."""
    extractor = mlim.vtkMultiLabelCurveExtractor()
    extractor.SetInputData(image)
    protector = mlim.vtkMultiLabelCurveProtector()
    protector.SetInputConnection(extractor.GetOutputPort())
    protector.SetEdgeSize(edge_size)
    protector.SetFacetDistance(facet_distance)
    protector.SetBallRadiusScale(ball_radius_scale)
    protector.Update()
    return extractor, protector


def digest(surface):
    """Of points, cells, their arrays and all field data but the times."""
    state = hashlib.sha256()

    def add(name, array):
        state.update(name.encode())
        if array.IsA("vtkDataArray"):
            state.update(vtk_to_numpy(array).tobytes())
        else:
            values = [array.GetValue(i) for i in range(array.GetNumberOfValues())]
            state.update(repr(values).encode())

    add("points", surface.GetPoints().GetData())
    for cells in (surface.GetVerts(), surface.GetLines(), surface.GetPolys()):
        add("cells", cells.GetOffsetsArray())
        add("cells", cells.GetConnectivityArray())
    for arrays in (surface.GetPointData(), surface.GetCellData(), surface.GetFieldData()):
        names = (arrays.GetArrayName(i) for i in range(arrays.GetNumberOfArrays()))
        for name in sorted(n for n in names if not n.startswith("Time")):
            add(name, arrays.GetAbstractArray(name))
    return state.hexdigest()


def through_file(polydata):
    with tempfile.TemporaryDirectory() as folder:
        path = os.path.join(folder, "balls.vtp")
        writer = vtkXMLPolyDataWriter()
        writer.SetInputData(polydata)
        writer.SetFileName(path)
        assert writer.Write()
        reader = vtkXMLPolyDataReader()
        reader.SetFileName(path)
        reader.Update()
        return reader.GetOutput()


class TestPipeline(unittest.TestCase):
    def test_stages_in_a_pipeline(self):
        for is_placed in (False, True):
            image = make_image(is_placed)
            direct = mlim.mesh(image)
            self.assertGreater(direct.GetNumberOfLines(), 0)
            self.assertGreater(direct.GetNumberOfVerts(), 0)
            _, protector = run_stages(image)
            staged = mlim.vtkMultiLabelInterfaceMesher()
            staged.SetInputData(image)
            staged.SetBallsConnection(protector.GetOutputPort())
            staged.Update()
            self.assertEqual(digest(direct), digest(staged.GetOutput()))
            balls = through_file(protector.GetOutput())
            self.assertEqual(digest(direct), digest(mlim.mesh(image, balls=balls)))

    def test_options_of_the_stages(self):
        image = make_image()
        default = mlim.mesh(image)
        direct = mlim.mesh(image, edge_size=1.1, ball_radius_scale=0.8)
        self.assertNotEqual(digest(default), digest(direct))
        facet_distance = direct.GetFieldData().GetArray("FacetDistance").GetValue(0)
        _, protector = run_stages(image, 1.1, facet_distance, 0.8)
        # The mesher takes both from the balls, whatever its own options say.
        staged = mlim.mesh(image, balls=protector.GetOutput(), edge_size=0.5)
        self.assertEqual(digest(direct), digest(staged))

    def test_sizes(self):
        """What FacetSize alone sets: half of it gives a mesh of about four times as many vertices, whose
        triangles keep all bounds; the smallest distance does not stand in the way."""
        image = make_image(False)
        counts = []
        for size in (1.0, 0.5):
            surface = mlim.mesh(image, facet_size=size)
            figures = surface.GetFieldData()
            value = lambda name: figures.GetArray(name).GetComponent(0, 0)
            self.assertAlmostEqual(value("SmallestDistance"), size / 8)
            self.assertAlmostEqual(value("FacetDistance"), size / 8)
            for name in ("UnresolvedSizeCount", "UnresolvedRatioCount", "LostLabelCount"):
                self.assertEqual(value(name), 0, name)
            check(audit(image, surface, size / 8))
            counts.append(surface.GetNumberOfPoints())
        self.assertGreater(counts[1], 3 * counts[0])
        self.assertLess(counts[1], 5 * counts[0])

    def test_balls_disconnect(self):
        image = make_image()
        extractor, protector = run_stages(image, edge_size=1.1)
        mesher = mlim.vtkMultiLabelInterfaceMesher()
        mesher.SetInputData(image)
        mesher.SetBallsConnection(protector.GetOutputPort())
        mesher.Update()
        with_balls = digest(mesher.GetOutput())
        mesher.RemoveBalls()
        mesher.Update()
        self.assertNotEqual(with_balls, digest(mesher.GetOutput()))
        self.assertEqual(digest(mlim.mesh(image)), digest(mesher.GetOutput()))

    def test_curves_and_balls(self):
        extractor, protector = run_stages(make_image())
        curves = extractor.GetOutput()
        balls = protector.GetOutput()
        sets = vtk_to_numpy(curves.GetCellData().GetArray("LabelSet"))
        sizes = vtk_to_numpy(curves.GetCellData().GetArray("LabelSetSize"))
        ids = vtk_to_numpy(curves.GetCellData().GetArray("CurveId"))
        self.assertTrue(((sets >= 0).sum(axis=1) == sizes).all())
        self.assertTrue((sizes >= 2).all())
        junctions = curves.GetNumberOfVerts()
        self.assertTrue((ids[:junctions] == -1).all())
        self.assertEqual(ids[junctions:].tolist(), list(range(curves.GetNumberOfLines())))
        # Three balls in the middle: labels 1, 2, 3 meet in one curve with two ends.
        inner = {tuple(s[s >= 0]) for s in sets[junctions:]}
        self.assertIn((1, 2, 3), inner)
        self.assertIn((0, 1, 2, 3), {tuple(s[s >= 0]) for s in sets[:junctions]})
        self.assertIn((0, 4), inner, "the ball that leaves the box has a crease there")

        radii = vtk_to_numpy(balls.GetPointData().GetArray("Radius"))
        centers = vtk_to_numpy(balls.GetPoints().GetData())
        self.assertTrue((radii > 0).all())
        self.assertEqual(balls.GetNumberOfVerts(), balls.GetNumberOfPoints())
        lines = vtk_to_numpy(balls.GetLines().GetConnectivityArray()).reshape(-1, 2)
        distances = np.linalg.norm(centers[lines[:, 0]] - centers[lines[:, 1]], axis=1)
        self.assertTrue((distances < radii[lines].sum(axis=1)).all(), "neighbours overlap")
        edge_size = balls.GetFieldData().GetArray("EdgeSize").GetValue(0)
        self.assertLessEqual(distances.max(), edge_size * (1 + 1e-9))

    def test_repeated_runs_and_threads(self):
        code = (
            "import sys; sys.path.insert(0, sys.argv[1])\n"
            "from TestPipeline import digest, make_image, mlim, vtkSMPTools\n"
            "vtkSMPTools.Initialize(int(sys.argv[2]))\n"
            "print(digest(mlim.mesh(make_image())))"
        )
        here = os.path.dirname(os.path.abspath(__file__))
        expected = digest(mlim.mesh(make_image()))
        for threads in ("1", "2", "2"):
            command = [sys.executable, "-c", code, here, threads]
            result = subprocess.run(command, check=True, capture_output=True, text=True)
            self.assertEqual(result.stdout.strip(), expected, f"{threads} threads")


if __name__ == "__main__":
    unittest.main()
