"""The filters in pvpython and pvbatch: arrays, second input, outputs, defaults, state file, abort,
errors."""

import time
import unittest

import numpy as np
from paraview import simple
from paraview.vtk import vtkOutputWindow, vtkStringOutputWindow

import plugin

REGIONS = 8
# Seconds of the processor from the wish to stop to the end of the run; not of the clock, so that a
# busy machine does not count.
MAX_STOP_TIME = 0.5


class Messages:
    """Keeps VTK's errors and warnings from being printed, and collects them."""

    def __enter__(self):
        self.before = vtkOutputWindow.GetInstance()
        self.window = vtkStringOutputWindow()
        vtkOutputWindow.SetInstance(self.window)
        return self

    def __exit__(self, *_):
        vtkOutputWindow.SetInstance(self.before)

    def text(self):
        return self.window.GetOutput()


def labels_of(mesher):
    labels = plugin.values(plugin.fetch(mesher), "BoundaryLabels")
    return set(labels[labels >= 0].tolist())


class TestPlugin(unittest.TestCase):
    def setUp(self):
        simple.ResetSession()
        plugin.load()
        self.image = plugin.read()
        self.image.UpdatePipeline()

    def mesher(self, **properties):
        return simple.MultiLabelInterfaceMesher(Input=self.image, **properties)

    def balls(self):
        curves = simple.MultiLabelCurveExtractor(Input=self.image)
        return simple.MultiLabelCurveProtector(Input=curves)

    def test_defaults_from_the_data(self):
        mesher = self.mesher()
        spacing = plugin.fetch(self.image).GetSpacing()[0]
        self.assertEqual(mesher.FacetSize, 2 * spacing)
        mesher.UpdatePipeline()
        with_default = plugin.digest(plugin.fetch(mesher))
        mesher.FacetSize = 0
        mesher.UpdatePipeline()
        self.assertEqual(plugin.digest(plugin.fetch(mesher)), with_default)

    def test_output(self):
        mesher = self.mesher()
        surface = plugin.fetch(mesher)
        self.assertGreater(surface.GetNumberOfPolys(), 1000)
        self.assertEqual(labels_of(mesher), set(range(REGIONS + 1)))
        for name in ("BoundaryLabels", "Label", "PatchId", "CurveId"):
            self.assertEqual(len(plugin.values(surface, name)), surface.GetNumberOfCells(), name)
        for name in ("NodeType", "NumberOfLabels"):
            tuples = len(plugin.values(surface, name, "PointData"))
            self.assertEqual(tuples, surface.GetNumberOfPoints(), name)
        self.assertEqual(plugin.values(surface, "LostLabelCount", "FieldData")[0], 0)
        self.assertEqual(mesher.Port, 0)
        self.assertEqual(mesher.SMProxy.GetOutputPortName(0), "Surface")

    def test_volume(self):
        mesher = self.mesher(FacetSize=0.12)
        self.assertEqual(mesher.SMProxy.GetOutputPortName(1), "Volume")
        self.assertEqual(plugin.fetch(mesher, 1).GetNumberOfCells(), 0)
        before = plugin.digest(plugin.fetch(mesher))
        mesher.VolumeMesh = 1
        volume = plugin.fetch(mesher, 1)
        labels = plugin.values(volume, "Label")
        self.assertEqual(set(labels.tolist()), set(range(1, REGIONS + 1)))
        self.assertEqual(plugin.digest(plugin.fetch(mesher)), before, "the surface stays")
        mesher.KeepBackground = 1
        labels = plugin.values(plugin.fetch(mesher, 1), "Label")
        self.assertIn(0, labels.tolist())
        view = simple.CreateRenderView()
        display = simple.Show(simple.OutputPort(mesher, 1), view)
        self.assertEqual(tuple(display.ColorArrayName), ("CELLS", "Label"))
        simple.Delete(view)

    def test_label_cell_sizes(self):
        mesher = self.mesher(FacetSize=0.12, VolumeMesh=1, RemoveSlivers=0)

        def counts():
            labels = plugin.values(plugin.fetch(mesher, 1), "Label")
            return np.bincount(labels, minlength=REGIONS + 1)

        self.assertEqual(list(mesher.LabelCellSizes), [])
        before = counts()
        mesher.LabelCellSizes = [1, 0.06, 3, 0.05]
        volume = plugin.fetch(mesher, 1)
        sizes = plugin.values(volume, "LabelCellSizes", "FieldData")
        self.assertEqual(np.reshape(sizes, (-1, 2)).tolist(), [[1, 0.06], [3, 0.05]])
        self.assertGreater(counts()[1], 1.5 * before[1])
        self.assertGreater(counts()[3], 1.5 * before[3])
        mesher.LabelCellSizes = [1.5, 0.01, 1e12, 0.01]
        self.assertEqual(counts().tolist(), before.tolist(), "ids that no label has")
        mesher.LabelCellSizes = []
        self.assertEqual(counts().tolist(), before.tolist())

    def test_array_selection(self):
        mesher = self.mesher()
        names = list(mesher.PointArrays)
        self.assertEqual(len(names), REGIONS + 1, "all are selected at first")
        background = [n for n in names if "background" in n.lower()]
        others = [n for n in names if n not in background]
        mesher.PointArrays = background + others[:2]
        self.assertEqual(labels_of(mesher), {0, 1, 2})
        mesher.PointArrays = []
        self.assertEqual(labels_of(mesher), set(range(REGIONS + 1)), "none means all")

    def test_background(self):
        mesher = self.mesher(BackgroundMode="Constant", BackgroundValue=0)
        mesher.PointArrays = ["sphere1", "sphere2"]
        self.assertEqual(labels_of(mesher), {0, 1, 2})
        mesher.BackgroundMode = "Array"
        mesher.BackgroundArrayName = "sphere2"
        self.assertEqual(labels_of(mesher), {0, 1})

    def test_balls_on_and_off(self):
        mesher = self.mesher()
        own = plugin.digest(plugin.fetch(mesher))
        mesher.Balls = self.balls()
        self.assertEqual(plugin.digest(plugin.fetch(mesher)), own)
        mesher.Balls.EdgeSize = 0.03
        finer = plugin.digest(plugin.fetch(mesher))
        self.assertNotEqual(finer, own)
        mesher.Balls = None
        self.assertEqual(plugin.digest(plugin.fetch(mesher)), own)

    def test_curves_and_balls(self):
        balls = self.balls()
        curves = plugin.fetch(balls.Input)
        self.assertGreater(curves.GetNumberOfLines(), REGIONS)
        self.assertGreater(curves.GetNumberOfVerts(), 0)
        covered = plugin.fetch(balls)
        self.assertGreater(plugin.values(covered, "Radius", "PointData").min(), 0)

    def test_first_view(self):
        view = simple.CreateRenderView()
        balls = self.balls()
        for source, array in (
            (self.mesher(), ("CELLS", "Label")),
            (balls.Input, ("CELLS", "CurveId")),
            (balls, ("POINTS", "Radius")),
        ):
            display = simple.Show(source, view)
            self.assertEqual(tuple(display.ColorArrayName), array)
            self.assertEqual(display.Representation, "Surface")
        simple.Render(view)
        simple.Delete(view)

    def test_state_file(self):
        mesher = self.mesher(FacetSize=0.07, CapBoundary=0, BackgroundMode="Complement")
        mesher.PointArrays = ["sphere1", "sphere2", "sphere3"]
        mesher.Balls = None
        before = plugin.digest(plugin.fetch(mesher))
        mesher = plugin.through_state_file(mesher)
        self.assertEqual(mesher.FacetSize, 0.07)
        self.assertEqual(mesher.CapBoundary, 0)
        self.assertEqual(mesher.BackgroundMode, "Complement")
        self.assertEqual(list(mesher.PointArrays), ["sphere1", "sphere2", "sphere3"])
        self.assertEqual(plugin.digest(plugin.fetch(mesher)), before)

    def test_state_file_with_balls(self):
        mesher = self.mesher(Balls=self.balls())
        mesher.Balls.EdgeSize = 0.05
        before = plugin.digest(plugin.fetch(mesher))
        mesher = plugin.through_state_file(mesher)
        self.assertEqual(plugin.digest(plugin.fetch(mesher)), before)

    def test_progress_and_abort(self):
        """What ParaView's abort button does: AbortExecute while the filter runs."""
        mesher = self.mesher(FacetSize=0.004)
        algorithm = mesher.GetClientSideObject()
        seen, asked = [], []

        def watch(caller, _event):
            if not asked:
                seen.append(caller.GetProgress())
            # In the midst of refinement, not at the first event.
            if not asked and time.process_time() - start > 1.5:
                asked.append(time.process_time())
                caller.SetAbortExecute(1)

        tag = algorithm.AddObserver("ProgressEvent", watch)
        start = time.process_time()
        mesher.UpdatePipeline()
        end = time.process_time()
        algorithm.RemoveObserver(tag)
        self.assertTrue(asked, "the run is long enough")
        self.assertLess(end - asked[0], MAX_STOP_TIME)
        self.assertEqual(seen, sorted(seen))
        self.assertGreater(len(seen), 20)
        surface = algorithm.GetOutputDataObject(0)
        self.assertEqual(surface.GetNumberOfPoints(), 0)
        self.assertEqual(surface.GetNumberOfCells(), 0)
        # And it runs again afterwards.
        algorithm.SetAbortExecute(0)
        mesher.FacetSize = 0.1
        self.assertGreater(plugin.fetch(mesher).GetNumberOfPolys(), 1000)

    def test_errors(self):
        mesher = self.mesher()
        mesher.PointArrays = ["sphere1", "no such array"]
        with Messages() as messages:
            mesher.UpdatePipeline()
        self.assertIn("The image has no array 'no such array', which is selected.", messages.text())
        self.assertEqual(plugin.fetch(mesher).GetNumberOfPoints(), 0)
        self.assertTrue(plugin.fetch(mesher).GetCellData().HasArray("BoundaryLabels"))

        values = np.zeros(4**3)
        values[7] = np.nan
        bad = plugin.source_of(plugin.make_image({"a": values, "b": values}, 4))
        mesher = simple.MultiLabelInterfaceMesher(Input=bad)
        with Messages() as messages:
            mesher.UpdatePipeline()
        self.assertIn('"a" has 1 values that are not finite', messages.text())

        balls = self.balls()
        other = plugin.source_of(plugin.make_image({"a": np.zeros(64), "b": np.ones(64)}, 4))
        mesher = simple.MultiLabelInterfaceMesher(Input=other, Balls=balls)
        with Messages() as messages:
            mesher.UpdatePipeline()
        self.assertIn("The balls were made for another image", messages.text())

    def test_array_with_components(self):
        """An image with one array of several components is offered the filter, and meshed."""
        size = 12
        grid = np.indices((size,) * 3).reshape(3, -1)
        inside = 3.7 - np.sqrt(((grid - 5.4) ** 2).sum(axis=0))
        image = plugin.make_image({"both": np.stack([0 * inside, inside], axis=1)}, size)
        mesher = simple.MultiLabelInterfaceMesher(Input=plugin.source_of(image))
        self.assertEqual(list(mesher.PointArrays), [])
        self.assertGreater(plugin.fetch(mesher).GetNumberOfPolys(), 50)


if __name__ == "__main__":
    plugin.load()
    unittest.main()
