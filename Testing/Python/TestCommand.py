"""The command line: files of all kinds in and out, messages, exit codes, Ctrl-C."""

import inspect
import os
import pty
import signal
import subprocess
import sys
import tempfile
import time
import unittest

import numpy as np
from vtkmodules.util.numpy_support import numpy_to_vtk, vtk_to_numpy
from vtkmodules.vtkCommonDataModel import vtkImageData
from vtkmodules.vtkIOImage import (
    vtkMetaImageWriter,
    vtkNIFTIImageWriter,
    vtkPNGWriter,
    vtkTIFFWriter,
)
from vtkmodules.vtkIOLegacy import vtkPolyDataWriter, vtkStructuredPointsWriter
from vtkmodules.vtkIOParallelXML import vtkXMLPImageDataWriter
from vtkmodules.vtkIOXML import (
    vtkXMLImageDataWriter,
    vtkXMLPolyDataReader,
    vtkXMLUnstructuredGridReader,
)

import mlim
from mlim import command
from TestPackage import labels_of, make_ball
from TestPipeline import digest, make_image

# Seconds of the processor from Ctrl-C to the end of the run; not of the clock, so that a busy machine
# does not count.
MAX_STOP_TIME = 0.5
SIZE = 20
# Of a region's volume from its voxels': of some 500, which VolumeTolerance does not hold.
MAX_SMALL_DIFFERENCE = 0.1


def soft_ball():
    """A ball in whole numbers, 128 at its surface, for files of slices."""
    image = make_ball()
    values = vtk_to_numpy(image.GetPointData().GetScalars())
    soft = np.clip(128 + 20 * values, 0, 255).astype(np.uint8)
    array = numpy_to_vtk(soft, deep=True)
    array.SetName("soft")
    image.GetPointData().SetScalars(array)
    return image


def label_map():
    """A ball with the id 3 beside one with the id 17, in an image with a spacing."""
    image = vtkImageData()
    image.SetDimensions(SIZE, SIZE, SIZE)
    image.SetSpacing(1.5, 1.5, 2)
    z, y, x = np.indices((SIZE, SIZE, SIZE)).reshape(3, -1)
    ids = np.zeros(SIZE**3, np.int16)
    for label, center in ((3, 7), (17, 12.5)):
        squares = (x - center) ** 2 + (y - 9.5) ** 2 + (z - 9.5) ** 2
        ids[(squares < 25) & (ids == 0)] = label
    array = numpy_to_vtk(ids, deep=True)
    array.SetName("labels")
    image.GetPointData().SetScalars(array)
    return image


def large_image():
    """Long to mesh finely: many balls."""
    size = 48
    image = vtkImageData()
    image.SetDimensions(size, size, size)
    z, y, x = np.indices((size, size, size)).reshape(3, -1)
    waves = np.sin(0.9 * x) + np.sin(0.8 * y) + np.sin(0.7 * z)
    for name, values in (("background", 0 * waves), ("waves", waves)):
        array = numpy_to_vtk(values, deep=True)
        array.SetName(name)
        image.GetPointData().AddArray(array)
    return image


class TestCommand(unittest.TestCase):
    def setUp(self):
        folder = tempfile.TemporaryDirectory()
        self.addCleanup(folder.cleanup)
        self.folder = folder.name

    def path(self, name):
        return os.path.join(self.folder, name)

    def write(self, writer, image, name):
        writer.SetInputData(image)
        writer.SetFileName(self.path(name))
        writer.Write()
        return self.path(name)

    def write_image(self, image=None):
        return self.write(vtkXMLImageDataWriter(), image or make_image(), "image.vti")

    def run_command(self, *words):
        """Exit code, stdout and stderr."""
        result = subprocess.run(
            [sys.executable, "-m", "mlim", *words], capture_output=True, text=True, timeout=120
        )
        return result.returncode, result.stdout, result.stderr

    def surface(self, name="out.vtp"):
        reader = vtkXMLPolyDataReader()
        reader.SetFileName(self.path(name))
        reader.Update()
        return reader.GetOutput()

    def test_mesh(self):
        code, out, error = self.run_command(self.write_image(), "-o", self.path("out.vtp"))
        self.assertEqual((code, error), (0, ""))
        self.assertIn("labels in the mesh", out)
        self.assertEqual(digest(self.surface()), digest(mlim.mesh(make_image())))

    def test_curves_and_balls(self):
        """Written along, from stages run one by one: the mesh is the same."""
        for size in ((), ("--facet-size", "1.4")):
            words = ("--curves", self.path("curves.vtp"), "--balls", self.path("balls.vtp"))
            image = self.write_image()
            code, out, _ = self.run_command(image, "-q", "-o", self.path("out.vtp"), *words, *size)
            self.assertEqual((code, out), (0, ""))
            expected = mlim.mesh(make_image(), facet_size=float(size[1]) if size else 0.0)
            self.assertEqual(digest(self.surface()), digest(expected))
            self.assertGreater(self.surface("curves.vtp").GetNumberOfLines(), 0)
            radii = self.surface("balls.vtp").GetPointData().GetArray("Radius")
            self.assertGreater(radii.GetNumberOfTuples(), 0)

    def test_options(self):
        words = ["--arrays", "ball 0", "ball 1", "--background", "0", "--no-curves"]
        words += ["--single-precision", "--facet-distance", "0.3", "--vertex-limit", "99999"]
        code, _, _ = self.run_command(self.write_image(), "-o", self.path("out.vtp"), *words)
        self.assertEqual(code, 0)
        surface = self.surface()
        self.assertEqual(labels_of(surface), {0, 1, 2})
        self.assertEqual(surface.GetNumberOfLines(), 0)
        self.assertEqual(surface.GetFieldData().GetArray("FacetDistance").GetValue(0), 0.3)
        self.assertEqual(surface.GetFieldData().GetArray("VertexLimit").GetValue(0), 99999)
        self.assertEqual(surface.GetPoints().GetData().GetDataTypeAsString(), "float")

    def test_volume(self):
        words = ("--volume", self.path("out.vtu"), "--cell-size", "3", "--label-cell-sizes", "1=2")
        code, out, error = self.run_command(
            self.write_image(), "-o", self.path("out.vtp"), *words
        )
        self.assertEqual((code, error), (0, ""))
        self.assertIn("Volume", out)
        reader = vtkXMLUnstructuredGridReader()
        reader.SetFileName(self.path("out.vtu"))
        reader.Update()
        labels = vtk_to_numpy(reader.GetOutput().GetCellData().GetArray("Label"))
        self.assertEqual(set(labels.tolist()), {1, 2, 3, 4})

    def test_every_option_of_mesh_is_reachable(self):
        known = set(vars(command._parser().parse_args(["in.vti", "-o", "out.vtp"])))
        renamed = {
            "image": "input",
            "cap_boundary": "no_caps",
            "output_curves": "no_curves",
            "remove_slivers": "keep_slivers",
        }
        for name in inspect.signature(mlim.mesh).parameters:
            self.assertIn(renamed.get(name, name), known)

    def test_readers(self):
        soft = soft_ball()
        slices = os.path.join(self.folder, "slices")
        os.mkdir(slices)
        writer = vtkPNGWriter()
        writer.SetInputData(soft)
        writer.SetFilePrefix(os.path.join(slices, "slice"))
        writer.SetFilePattern("%s_%03d.png")
        writer.Write()
        files = [
            slices,
            self.write(vtkXMLImageDataWriter(), soft, "image.vti"),
            self.write(vtkXMLPImageDataWriter(), soft, "image.pvti"),
            self.write(vtkStructuredPointsWriter(), soft, "image.vtk"),
            self.write(vtkMetaImageWriter(), soft, "image.mhd"),
            self.write(vtkMetaImageWriter(), soft, "other.mha"),
            self.write(vtkNIFTIImageWriter(), soft, "image.nii.gz"),
            self.write(vtkTIFFWriter(), soft, "image.tif"),
        ]
        expected = mlim.mesh(soft, background=128)
        for path in files:
            surface = mlim.mesh(path, background=128)
            triangles = surface.GetNumberOfPolys()
            self.assertLess(abs(triangles - expected.GetNumberOfPolys()), 30, path)
            sizes = [np.ptp(np.reshape(d.GetBounds(), (3, 2)), axis=1) for d in (surface, expected)]
            np.testing.assert_allclose(*sizes, atol=0.2, err_msg=path)

    def test_label_maps(self):
        """Files of labels are meshed as such, with their ids, as through the indicators filter."""
        image = label_map()
        ids = vtk_to_numpy(image.GetPointData().GetScalars())
        voxel = np.prod(image.GetSpacing())
        for path in (
            self.write(vtkNIFTIImageWriter(), image, "map.nii.gz"),
            self.write(vtkMetaImageWriter(), image, "map.mha"),
            self.write_image(image),
        ):
            words = (path, "-o", self.path("out.vtp"), "--volume", self.path("out.vtu"))
            code, out, error = self.run_command(*words)
            self.assertEqual((code, error), (0, ""), path)
            self.assertRegex(out, r"labels in the mesh +3 of 3\n", path)
            surface = self.surface()
            self.assertEqual(labels_of(surface), {0, 3, 17}, path)
            fields = surface.GetFieldData()
            volumes = dict(
                zip(
                    vtk_to_numpy(fields.GetArray("LabelIds")).tolist(),
                    vtk_to_numpy(fields.GetArray("LabelVolumes")).tolist(),
                )
            )
            for label in (3, 17):
                expected = (ids == label).sum() * voxel
                self.assertLess(abs(volumes[label] / expected - 1), MAX_SMALL_DIFFERENCE, path)
            indicators = mlim.vtkMultiLabelIndicators()
            indicators.SetInputData(mlim.read(path))
            indicators.Update()
            through = mlim.mesh(indicators.GetOutput())
            self.assertEqual(digest(surface), digest(through), path)
            reader = vtkXMLUnstructuredGridReader()
            reader.SetFileName(self.path("out.vtu"))
            reader.Update()
            labels = vtk_to_numpy(reader.GetOutput().GetCellData().GetArray("Label"))
            self.assertEqual(set(labels.tolist()), {3, 17}, path)

    def test_writers(self):
        image = self.write_image()
        for name in ("out.vtk", "out.stl", "out.ply", "out.obj"):
            code, _, error = self.run_command(image, "-q", "-o", self.path(name))
            self.assertEqual((code, error), (0, ""), name)
            self.assertGreater(os.path.getsize(self.path(name)), 10_000, name)

    def check_failure(self, words, code, *sentences):
        found, _, error = self.run_command(*words)
        self.assertEqual(found, code, error)
        for sentence in sentences:
            self.assertIn(sentence, error)
        self.assertNotIn("Traceback", error)

    def test_failures(self):
        out = ("-o", self.path("out.vtp"))
        image = self.write_image()
        self.check_failure([self.path("none.vti"), *out], 1, "none.vti: no such file")
        text = self.path("text.csv")
        with open(text, "w", encoding="ascii") as file:
            file.write("1, 2, 3\n")
        self.check_failure([text, *out], 1, "text.csv: not an image", ".nii.gz", ".nrrd")
        mesh = self.write(vtkPolyDataWriter(), mlim.mesh(make_image()), "mesh.vtk")
        self.check_failure([mesh, *out], 1, "mesh.vtk")
        self.check_failure([self.folder, *out], 1, "neither a DICOM series nor slices")
        self.check_failure([image, "-o", self.path("out.txt")], 1, "out.txt", ".vtp")
        self.check_failure([image, "-o", self.path("no/out.vtp")], 1, "no such folder")
        self.check_failure([image, *out, "--arrays", "x"], 1, "The image has no array 'x'")
        self.check_failure([image, *out, "--facet-size", "nan"], 1, "FacetSize")
        self.check_failure([image], 2, "-o")
        self.check_failure([image, *out, "--facet-size", "big"], 2, "big")
        self.check_failure([image, *out, "--vertex-limit", "120"], 0, "warning: Refinement stopped")

    def test_header_that_lies(self):
        with open(self.write_image(), encoding="latin-1") as file:
            text = file.read()
        lie = "0 99999 0 99999 0 99999"
        extent = text.split('WholeExtent="', 1)[1].split('"', 1)[0]
        with open(self.path("lie.vti"), "w", encoding="latin-1") as file:
            file.write(text.replace(extent, lie))
        with self.assertRaisesRegex(OSError, "its header promises"):
            mlim.read(self.path("lie.vti"))

    def test_progress_on_a_terminal(self):
        image = self.write_image(large_image())
        main, terminal = pty.openpty()
        process = subprocess.Popen(
            [sys.executable, "-m", "mlim", image, "-o", self.path("out.vtp")],
            stdout=subprocess.DEVNULL,
            stderr=terminal,
        )
        os.close(terminal)
        text = b""
        while True:
            try:
                part = os.read(main, 4096)
            except OSError:  # the other end is closed
                break
            if not part:
                break
            text += part
        os.close(main)
        self.assertEqual(process.wait(), 0)
        lines = text.decode().split("\r")
        self.assertTrue(any("Refining the interface" in line and "#" in line for line in lines))
        self.assertNotIn("#", lines[-1], "the line is cleared at the end")

    def test_interrupt(self):
        """Ctrl-C in the midst of refinement: exit code 130, and no file."""
        image = self.write_image(large_image())
        words = ["--facet-size", "0.3", "--progress", "-o", self.path("out.vtp")]
        process = subprocess.Popen(
            [sys.executable, "-m", "mlim", image, *words], stderr=subprocess.PIPE, text=True
        )
        seen = ""
        while "Refining" not in seen:
            part = process.stderr.read(1)
            self.assertTrue(part, f"ended too early: {seen}")
            seen += part
        time.sleep(0.5)
        with open(f"/proc/{process.pid}/stat", encoding="ascii") as file:
            ticks = file.read().rsplit(")", 1)[1].split()[11:13]
        begin = sum(map(int, ticks)) / os.sysconf("SC_CLK_TCK")
        process.send_signal(signal.SIGINT)
        error = process.stderr.read()
        process.stderr.close()
        _, status, usage = os.wait4(process.pid, 0)
        process.returncode = os.waitstatus_to_exitcode(status)
        self.assertEqual(process.returncode, 130, error)
        self.assertIn("interrupted", error)
        self.assertFalse(os.path.exists(self.path("out.vtp")))
        # With the end of the program itself.
        self.assertLess(usage.ru_utime + usage.ru_stime - begin, 2 * MAX_STOP_TIME)

    def test_interrupt_of_a_filter(self):
        """KeyboardInterrupt from mlim.update, soon, with an empty typed output; then it runs again."""
        mesher = mlim.vtkMultiLabelInterfaceMesher()
        mesher.SetInputData(large_image())
        mesher.SetFacetSize(0.3)
        sent = []

        def send(fraction, stage):
            if not sent and stage.startswith("Refining") and fraction > 0.25:
                sent.append(time.process_time())
                os.kill(os.getpid(), signal.SIGINT)

        with self.assertRaises(KeyboardInterrupt):
            mlim.update(mesher, send)
        self.assertLess(time.process_time() - sent[0], MAX_STOP_TIME)
        surface = mesher.GetOutput()
        self.assertEqual((surface.GetNumberOfPoints(), surface.GetNumberOfCells()), (0, 0))
        self.assertTrue(surface.GetCellData().HasArray("BoundaryLabels"))
        mesher.SetFacetSize(3)
        mlim.update(mesher)
        self.assertGreater(mesher.GetOutput().GetNumberOfPolys(), 100)


if __name__ == "__main__":
    unittest.main()
