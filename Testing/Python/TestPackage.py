"""The package mlim: one call from an image or a file to a mesh, errors as exceptions, the report."""

import os
import tempfile
import unittest

import numpy as np
from vtkmodules.util.numpy_support import numpy_to_vtk, vtk_to_numpy
from vtkmodules.vtkCommonDataModel import vtkImageData
from vtkmodules.vtkCommonMath import vtkMatrix4x4
from vtkmodules.vtkIOImage import vtkMetaImageWriter, vtkNIFTIImageWriter
from vtkmodules.vtkIOXML import vtkXMLImageDataWriter

import mlim
from TestPipeline import digest, make_image


def make_ball(name="ball"):
    """The signed distance of one ball, in an image of 20^3 points."""
    image = vtkImageData()
    image.SetDimensions(20, 20, 20)
    grid = np.indices((20, 20, 20)).reshape(3, -1)
    values = 6.3 - np.sqrt(((grid - 9.6) ** 2).sum(axis=0))
    array = numpy_to_vtk(values.astype(np.float32), deep=True)
    array.SetName(name)
    image.GetPointData().SetScalars(array)
    return image


def labels_of(surface):
    labels = vtk_to_numpy(surface.GetCellData().GetArray("BoundaryLabels"))
    return set(labels[labels >= 0].ravel().tolist())


class TestMesh(unittest.TestCase):
    def test_label_map(self):
        image = make_ball()
        distances = vtk_to_numpy(image.GetPointData().GetScalars())
        array = numpy_to_vtk(np.where(distances > 0, -40, 0).astype(np.int16), deep=True)
        array.SetName("labels")
        image.GetPointData().SetScalars(array)
        surface = mlim.mesh(image)
        self.assertEqual(surface.GetFieldData().GetArray("LabelIds").GetRange(), (-40, 0))
        radii = np.linalg.norm(vtk_to_numpy(surface.GetPoints().GetData()) - 9.6, axis=1)
        # As smooth as it can be: voxels of the ball lie up to 0.87 off its surface.
        self.assertLess(radii.std(), 0.12)
        self.assertLess(abs(radii.mean() - 6.3), 0.1)
        indicators = mlim.vtkMultiLabelIndicators()
        indicators.SetInputData(image)
        indicators.Update()
        self.assertEqual(digest(mlim.mesh(indicators.GetOutput())), digest(surface))

    def test_arrays(self):
        image = make_image()
        self.assertEqual(labels_of(mlim.mesh(image)), {0, 1, 2, 3, 4})
        self.assertEqual(labels_of(mlim.mesh(image, ["background", "ball 0"])), {0, 1})
        self.assertEqual(labels_of(mlim.mesh(image, ["ball 0", "ball 1"], 0)), {0, 1, 2})
        self.assertEqual(labels_of(mlim.mesh(image, "ball 1", 0.5)), {0, 1})
        named = mlim.mesh(image, ["background", "ball 0"], "ball 0")
        self.assertEqual(named.GetFieldData().GetAbstractArray("LabelNames").GetValue(1), "ball 0")

    def test_options(self):
        options = {
            "FacetSize": 1.9,
            "FacetRadiusEdgeRatio": 1.2,
            "FacetDistance": 0.31,
            "VolumeTolerance": 0.05,
            "EdgeSize": 1.3,
            "BallRadiusScale": 0.7,
            "CrossingTolerance": 1e-5,
            "JunctionMergeTolerance": 0.13,
            "OracleMode": 1,
            "VertexLimit": 12345,
            "MinimumComponentVoxels": 41,
        }
        surface = mlim.mesh(
            make_image(),
            facet_size=1.9,
            facet_radius_edge_ratio=1.2,
            facet_distance=0.31,
            volume_tolerance=0.05,
            edge_size=1.3,
            ball_radius_scale=0.7,
            crossing_tolerance=1e-5,
            junction_merge_tolerance=0.13,
            oracle_mode="bisection",
            tie_breaking="lowest_index",
            unseen_labels="keep",
            vertex_limit=12345,
            minimum_component_voxels=41,
            output_curves=False,
            single_precision=True,
        )
        for name, value in options.items():
            self.assertEqual(surface.GetFieldData().GetArray(name).GetTuple1(0), value, name)
        self.assertEqual(surface.GetNumberOfLines(), 0)
        self.assertEqual(surface.GetPoints().GetData().GetDataTypeAsString(), "float")
        with self.assertRaisesRegex(ValueError, "oracle_mode"):
            mlim.mesh(make_image(), oracle_mode="best")
        with self.assertRaisesRegex(ValueError, "unseen_labels"):
            mlim.mesh(make_image(), unseen_labels="hide")

    def test_errors(self):
        image = make_image()
        with self.assertRaisesRegex(mlim.MeshError, "no array 'none'"):
            mlim.mesh(image, ["none"])
        with self.assertRaisesRegex(mlim.MeshError, "FacetSize"):
            mlim.mesh(image, facet_size=float("nan"))
        with self.assertRaisesRegex(mlim.MeshError, "image is empty"):
            mlim.mesh(vtkImageData())
        self.assertTrue(issubclass(mlim.MeshError, RuntimeError))

    def test_progress(self):
        seen = []
        surface = mlim.mesh(make_image(), progress=lambda *report: seen.append(report))
        self.assertGreater(surface.GetNumberOfPolys(), 0)
        fractions = [fraction for fraction, _ in seen]
        self.assertEqual(fractions, sorted(fractions))
        self.assertEqual(fractions[-1], 1.0)
        self.assertIn("Refining the interface", {stage for _, stage in seen})
        with self.assertRaisesRegex(mlim.MeshError, "Stopped"):
            mlim.mesh(make_image(), progress=lambda fraction, _: fraction < 0.3)
        with self.assertRaises(ZeroDivisionError):
            mlim.mesh(make_image(), progress=lambda fraction, _: 1 / 0)

    def test_label_map(self):
        image = vtkImageData()
        image.SetDimensions(4, 4, 4)
        labels = numpy_to_vtk(np.arange(64, dtype=np.int16), deep=True)
        labels.SetName("ids")
        image.GetPointData().SetScalars(labels)
        self.assertEqual(labels_of(mlim.mesh(image)), set(range(64)))
        # With a background it is one indicator function, as soft masks are.
        self.assertEqual(labels_of(mlim.mesh(image, background=31.5)), {0, 1})

    def test_stages(self):
        image = make_image()
        covered = mlim.balls(mlim.curves(image))
        self.assertEqual(digest(mlim.mesh(image, balls=covered)), digest(mlim.mesh(image)))

    def test_warnings(self):
        with self.assertWarnsRegex(mlim.MeshWarning, "vertex limit of 120"):
            mlim.mesh(make_image(), vertex_limit=120)

    def test_report(self):
        surface = mlim.mesh(make_image())
        self.assertEqual(surface.GetFieldData().GetArray("DiskFailurePoints").GetNumberOfTuples(), 0)
        text = mlim.report(surface)
        self.assertIn(f"{surface.GetNumberOfPolys():,}", text)
        for word in ("vertices", "curves", "radius-edge", "labels in the mesh", "Seconds"):
            self.assertIn(word, text)
        with self.assertRaisesRegex(ValueError, "not a finished mesh"):
            mlim.report(type(surface)())


class TestFiles(unittest.TestCase):
    def setUp(self):
        folder = tempfile.TemporaryDirectory()
        self.addCleanup(folder.cleanup)
        self.folder = folder.name

    def path(self, name):
        return os.path.join(self.folder, name)

    def test_vti(self):
        image = make_image()
        writer = vtkXMLImageDataWriter()
        writer.SetInputData(image)
        writer.SetFileName(self.path("image.vti"))
        self.assertTrue(writer.Write())
        self.assertEqual(digest(mlim.mesh(self.path("image.vti"))), digest(mlim.mesh(image)))

    def test_meta(self):
        image = make_ball()
        image.SetSpacing(0.5, 0.5, 0.5)
        writer = vtkMetaImageWriter()
        writer.SetInputData(image)
        writer.SetFileName(self.path("image.mha"))
        writer.Write()
        surface = mlim.mesh(self.path("image.mha"), background=0)
        expected = mlim.mesh(image, background=0)
        self.assertEqual(surface.GetNumberOfPolys(), expected.GetNumberOfPolys())
        np.testing.assert_allclose(surface.GetBounds(), expected.GetBounds(), atol=1e-6)

    def test_nrrd(self):
        image = make_ball()
        values = vtk_to_numpy(image.GetPointData().GetScalars())
        header = (
            "NRRD0004\ntype: float\ndimension: 3\nspace dimension: 3\nsizes: 20 20 20\n"
            "space directions: (2,0,0) (0,2,0) (0,0,2)\nspace origin: (1,2,3)\n"
            "endian: little\nencoding: raw\n\n"
        )
        with open(self.path("image.nrrd"), "wb") as file:
            file.write(header.encode() + values.astype("<f4").tobytes())
        surface = mlim.mesh(self.path("image.nrrd"), background=0)
        center = np.array(surface.GetCenter())
        np.testing.assert_allclose(center, 2 * 9.6 + np.array([1, 2, 3]), atol=0.2)

    def test_axes_in_headers(self):
        """The file's first axis along y, the second along -x, the third along z."""
        values = vtk_to_numpy(make_ball().GetPointData().GetScalars()).astype("<f4").tobytes()
        meta = (
            "ObjectType = Image\nNDims = 3\nBinaryData = True\nBinaryDataByteOrderMSB = False\n"
            "TransformMatrix = 0 1 0 -1 0 0 0 0 1\nOffset = 1 2 3\nElementSpacing = 2 2 2\n"
            "DimSize = 20 20 20\nElementType = MET_FLOAT\nElementDataFile = LOCAL\n"
        )
        nrrd = (
            "NRRD0004\ntype: float\ndimension: 3\nspace: right-anterior-superior\n"
            "sizes: 20 20 20\nspace directions: (0,2,0) (-2,0,0) (0,0,2)\n"
            "space origin: (1,2,3)\nendian: little\nencoding: raw\n\n"
        )
        for name, header in (("image.mha", meta), ("image.nrrd", nrrd)):
            with open(self.path(name), "wb") as file:
                file.write(header.encode() + values)
            center = mlim.mesh(self.path(name), background=0).GetCenter()
            expected = (1 - 2 * 9.6, 2 + 2 * 9.6, 3 + 2 * 9.6)
            np.testing.assert_allclose(center, expected, atol=0.2, err_msg=name)

    def test_nifti(self):
        matrix = vtkMatrix4x4()
        # x to the left, y and z exchanged, and a position: all in the file's matrix.
        rows = ((-2, 0, 0, 50), (0, 0, 3, -7), (0, 2.5, 0, 11))
        for r, row in enumerate(rows):
            for c, value in enumerate(row):
                matrix.SetElement(r, c, value)
        image = make_ball()
        image.SetSpacing(2, 2.5, 3)
        writer = vtkNIFTIImageWriter()
        writer.SetInputData(image)
        writer.SetSFormMatrix(matrix)
        writer.SetQFormMatrix(matrix)
        for name in ("image.nii", "image.nii.gz"):
            writer.SetFileName(self.path(name))
            writer.Write()
            center = np.array(mlim.mesh(self.path(name), background=0).GetCenter())
            expected = [row[3] + 9.6 * sum(row[:3]) for row in rows]
            np.testing.assert_allclose(center, expected, atol=0.3)

    def test_refused(self):
        with self.assertRaisesRegex(FileNotFoundError, "none.vti"):
            mlim.mesh(self.path("none.vti"))
        with open(self.path("image.txt"), "w", encoding="ascii") as file:
            file.write("no image")
        with self.assertRaisesRegex(ValueError, "image.txt: not an image"):
            mlim.read(self.path("image.txt"))
        with open(self.path("broken.vti"), "w", encoding="ascii") as file:
            file.write("no image")
        with self.assertRaisesRegex(OSError, "broken.vti"):
            mlim.read(self.path("broken.vti"))


if __name__ == "__main__":
    unittest.main()
