"""Label maps in pvpython: straight into the mesher, and through the indicators filter."""

import os
import tempfile
import unittest

import numpy as np
from paraview import simple
from paraview.vtk import vtkImageData
from paraview.vtk.util.numpy_support import numpy_to_vtk
from paraview.vtk.vtkIOXML import vtkXMLImageDataWriter

import plugin

SIZE = 24
# Ids of two balls that overlap; the first has the overlap. 0 is the background.
IDS = (7, -3)
CENTERS = ((9, 11.5, 11.5), (15, 11.5, 11.5))
RADIUS = 7


def map_values():
    z, y, x = np.indices((SIZE,) * 3).reshape(3, -1)
    values = np.zeros(SIZE**3, np.int16)
    for label, center in reversed(list(zip(IDS, CENTERS))):
        squares = sum((a - b) ** 2 for a, b in zip((x, y, z), center))
        values[squares < RADIUS**2] = label
    return values


def cell_image():
    """The map on the cells of an image whose cells' centres are where the points of the other are."""
    image = vtkImageData()
    image.SetDimensions(SIZE + 1, SIZE + 1, SIZE + 1)
    image.SetOrigin(-0.5, -0.5, -0.5)
    array = numpy_to_vtk(map_values(), deep=True)
    array.SetName("labels")
    image.GetCellData().AddArray(array)
    return image


def array_names(data, owner="PointData"):
    arrays = getattr(data, "Get" + owner)()
    return [arrays.GetArrayName(i) for i in range(arrays.GetNumberOfArrays())]


def label_ids(surface):
    return set(np.unique(plugin.values(surface, "BoundaryLabels")).tolist()) - {-1}


class TestLabelMap(unittest.TestCase):
    def setUp(self):
        simple.ResetSession()
        plugin.load()
        self.image = plugin.source_of(plugin.make_image({"labels": map_values()}, SIZE))

    def mesh(self, source):
        # So that the mesher knows the arrays, as after Apply.
        source.UpdatePipeline()
        return plugin.fetch(simple.MultiLabelInterfaceMesher(Input=source))

    def test_direct_mesh(self):
        surface = self.mesh(self.image)
        self.assertEqual(label_ids(surface), {0, *IDS})
        self.assertEqual(plugin.values(surface, "LostLabelCount", "FieldData")[0], 0)
        self.assertGreater(surface.GetNumberOfLines(), 0, "the circle where three labels meet")
        # Away from the other ball the surface is the ball's, not its voxels'.
        points = plugin.vtk_to_numpy(surface.GetPoints().GetData())
        left = points[points[:, 0] < CENTERS[0][0]]
        radii = np.linalg.norm(left - CENTERS[0], axis=1)
        self.assertLess(radii.std(), 0.15)

    def test_indicators_give_the_same_mesh(self):
        for data in (None, cell_image()):
            source = plugin.source_of(data) if data else self.image
            owner = "CELLS" if data else "POINTS"
            simple.SetActiveSource(source)
            indicators = simple.MultiLabelIndicators(Input=source)
            self.assertEqual(list(indicators.LabelArray), [owner, "labels"])
            names = array_names(plugin.fetch(indicators), "CellData" if data else "PointData")
            self.assertEqual(names, ["label_-3", "background", "label_7"])
            self.assertEqual(indicators.SMProxy.GetOutputPortName(0), "Indicators")
            through = self.mesh(indicators)
            direct = self.mesh(source)
            self.assertGreater(direct.GetNumberOfPolys(), 100, owner)
            self.assertEqual(plugin.digest(through), plugin.digest(direct), owner)

    def test_array_is_chosen(self):
        arrays = {"labels": map_values(), "halves": (map_values() == IDS[0]).astype(float)}
        source = plugin.source_of(plugin.make_image(arrays, SIZE))
        indicators = simple.MultiLabelIndicators(Input=source)
        indicators.LabelArray = ["POINTS", "halves"]
        self.assertEqual(label_ids(self.mesh(indicators)), {0, 1}, "whole numbers as floats")
        indicators.LabelArray = ["POINTS", "labels"]
        self.assertEqual(label_ids(self.mesh(indicators)), {0, *IDS})
        mesher = simple.MultiLabelInterfaceMesher(Input=source, PointArrays=["labels"])
        self.assertEqual(label_ids(plugin.fetch(mesher)), {0, *IDS}, "selected alone")

    def test_labels(self):
        indicators = simple.MultiLabelIndicators(Input=self.image)
        self.assertEqual(list(indicators.Labels), [])
        for ids, wanted in (([7], {0, 7}), ([-3, 7], {0, -3, 7}), ([-3], {0, -3}), ([], {0, *IDS})):
            indicators.Labels = ids
            self.assertEqual(label_ids(self.mesh(indicators)), wanted)

    def test_background_label(self):
        values = map_values()
        source = plugin.source_of(
            plugin.make_image({"labels": np.where(values == 0, 5, values)}, SIZE)
        )
        indicators = simple.MultiLabelIndicators(Input=source, BackgroundLabel=5)
        self.assertEqual(plugin.digest(self.mesh(indicators)), plugin.digest(self.mesh(self.image)))

    def test_every_option_reaches_the_filter(self):
        """Each of these gives arrays that no other one gives."""
        changes = (
            {},
            {"Method": "Gaussian Mask"},
            {"DistanceBand": 2},
            {"MedianRadius": 2},
            {"DilateRadius": 1},
            {"GaussianSmoothing": 0},
            {"GaussianSigma": 0.9},
            {"PreserveVolume": 0},
            {"CurvatureDiffusionIterations": 5},
            {"CurvatureDiffusionIterations": 5, "CurvatureDiffusionTimeStep": 0.1},
            {"KeepThinLabels": 0},
        )
        values = map_values()
        values[0] = IDS[0]  # a speck
        source = plugin.source_of(plugin.make_image({"labels": values}, SIZE))
        seen = {}
        for change in changes:
            data = plugin.fetch(simple.MultiLabelIndicators(Input=source, **change))
            arrays = [plugin.values(data, n, "PointData").tobytes() for n in array_names(data)]
            found = b"".join(arrays)
            self.assertNotIn(found, seen, (change, seen.get(found)))
            seen[found] = change

    def test_state_file(self):
        with tempfile.TemporaryDirectory() as folder:
            path = os.path.join(folder, "map.vti")
            writer = vtkXMLImageDataWriter()
            writer.SetInputData(plugin.make_image({"labels": map_values()}, SIZE))
            writer.SetFileName(path)
            writer.Write()
            reader = plugin.read(path)
            reader.UpdatePipeline()
            indicators = simple.MultiLabelIndicators(
                Input=reader, Labels=[7], Method="Gaussian Mask", GaussianSigma=0.8
            )
            before = plugin.digest(self.mesh(indicators))
            indicators = plugin.through_state_file(indicators)
            self.assertEqual(list(indicators.Labels), [7])
            self.assertEqual(indicators.Method, "Gaussian Mask")
            self.assertEqual(indicators.GaussianSigma, 0.8)
            self.assertEqual(list(indicators.LabelArray), ["POINTS", "labels"])
            self.assertEqual(plugin.digest(self.mesh(indicators)), before)

    def test_progress_names_the_stage(self):
        for make in (simple.MultiLabelIndicators, simple.MultiLabelInterfaceMesher):
            proxy = make(Input=self.image)
            texts = []
            algorithm = proxy.GetClientSideObject()
            tag = algorithm.AddObserver(
                "ProgressEvent", lambda caller, _: texts.append(caller.GetProgressText())
            )
            proxy.UpdatePipeline()
            algorithm.RemoveObserver(tag)
            stages = [text for text in texts if text]
            self.assertEqual(stages[0], "Making indicators of the labels")
        self.assertIn("Refining the interface", stages)


if __name__ == "__main__":
    plugin.load()
    unittest.main()
