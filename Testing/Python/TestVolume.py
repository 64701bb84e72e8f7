"""Volumes of the example images, judged from the outside, and as files of other programs."""

import subprocess
import sys
import tempfile
import unittest
from pathlib import Path

import numpy as np
from vtkmodules.util.numpy_support import vtk_to_numpy

import mlim
from audit_volume import Volume, audit_volume, volume_failures
from TestPackage import make_ball
from TestPipeline import make_image
from TestRealData import read_image

try:
    import meshio
except ImportError:
    meshio = None

EXAMPLE_DATA = Path(__file__).resolve().parents[2] / "ExampleData"


def bytes_of(surface):
    points = vtk_to_numpy(surface.GetPoints().GetData()).tobytes()
    return points + vtk_to_numpy(surface.GetPolys().GetConnectivityArray()).tobytes()


def value(output, name):
    return vtk_to_numpy(output.GetFieldData().GetArray(name))[0]


def radii(grid):
    volume = Volume(grid)
    p, q, r, s = volume.corners()
    a, b, c = q - p, r - p, s - p
    dots = [np.einsum("ij,ij->i", v, v)[:, None] for v in (a, b, c)]
    centre = dots[0] * np.cross(b, c) + dots[1] * np.cross(c, a) + dots[2] * np.cross(a, b)
    six = np.einsum("ij,ij->i", a, np.cross(b, c))
    return volume.labels, np.linalg.norm(centre, axis=1) / np.abs(2 * six)


class TestVolume(unittest.TestCase):
    def test_examples(self):
        for name in ("spheres", "tissue"):
            with self.subTest(name):
                image = read_image(EXAMPLE_DATA / f"{name}.vti")
                surface, volume = mlim.mesh(image, volume=True)
                self.assertEqual(bytes_of(surface), bytes_of(mlim.mesh(image)))
                figures = audit_volume(image, surface, volume)
                self.assertEqual(volume_failures(figures), [])
                self.assertEqual(value(volume, "CellCount"), figures["cells"])
                self.assertEqual(value(volume, "UnresolvedSliverCount"), figures["below_10"])
                self.assertAlmostEqual(
                    value(volume, "MinDihedralAngle"), figures["min_angle"], places=6
                )

    def test_off(self):
        surface = mlim.mesh(make_ball(), background=0)
        self.assertEqual(surface.GetClassName(), "vtkPolyData")
        mesher = mlim.vtkMultiLabelInterfaceMesher()
        mesher.SetInputData(make_ball())
        mesher.Update()
        self.assertEqual(mesher.GetVolumeOutput().GetNumberOfCells(), 0)
        self.assertIsNotNone(mesher.GetVolumeOutput().GetCellData().GetArray("Label"))

    def test_mirror(self):
        """Positive volumes also where the direction matrix is a mirror, and on another spacing."""
        image = make_image()
        image.GetDirectionMatrix().Identity()
        image.GetDirectionMatrix().SetElement(0, 0, -1.0)
        image.SetSpacing(0.5, 0.7, 0.6)
        surface, volume = mlim.mesh(image, volume=True)
        figures = audit_volume(image, surface, volume)
        self.assertEqual(volume_failures(figures), [])

    def test_sizes(self):
        image = make_image()
        _, coarse = mlim.mesh(image, volume=True, cell_size=6)
        _, fine = mlim.mesh(image, volume=True, cell_size=6, label_cell_sizes={2: 1.0})
        before, after = radii(coarse), radii(fine)
        self.assertGreater((after[0] == 2).sum(), 2 * (before[0] == 2).sum())
        self.assertLess(np.quantile(after[1][after[0] == 2], 0.9), 1.2)
        self.assertGreater(np.quantile(after[1][after[0] == 1], 0.9), 1.2)
        sizes = vtk_to_numpy(fine.GetFieldData().GetArray("LabelCellSizes"))
        self.assertEqual(sizes.tolist(), [[2.0, 1.0]])
        with self.assertRaises(ValueError):
            mlim.mesh(image, volume=True, label_cell_sizes={2: -1.0})

    def test_slivers(self):
        image = make_image()
        _, volume = mlim.mesh(image, volume=True, cell_size=1.5, remove_slivers=False)
        self.assertEqual(value(volume, "ExchangeCount"), 0)
        self.assertLess(value(volume, "MinDihedralAngle"), 10)

    def test_background(self):
        image = make_image()
        _, volume = mlim.mesh(image, volume=True, keep_background=True)
        mesh = Volume(volume)
        box = np.prod((np.array(image.GetDimensions()) - 1) * np.array(image.GetSpacing()))
        self.assertIn(0, mesh.labels)
        self.assertTrue((mesh.volumes() > 0).all())
        self.assertAlmostEqual(mesh.volumes().sum() / box, 1.0, places=9)

    def test_report(self):
        _, volume = mlim.mesh(make_ball(), background=0, volume=True)
        text = mlim.report(volume)
        self.assertIn("tetrahedra", text)
        self.assertIn(f"{volume.GetNumberOfCells():,}", text)


@unittest.skipIf(meshio is None, "meshio is not importable: install python3-meshio")
class TestFiles(unittest.TestCase):
    @classmethod
    def setUpClass(cls):
        cls.surface, cls.volume = mlim.mesh(make_image(), volume=True)
        cls.mesh = Volume(cls.volume)
        cls.counts = {
            label: int((cls.mesh.labels == label).sum()) for label in np.unique(cls.mesh.labels)
        }

    def write(self, name, surface=None):
        folder = tempfile.TemporaryDirectory()
        self.addCleanup(folder.cleanup)
        path = Path(folder.name) / name
        mlim.write_volume(self.volume, path, surface)
        return path

    def check_cells(self, read):
        cells = np.concatenate([b.data for b in read.cells if b.type == "tetra"])
        own = np.concatenate(
            [self.mesh.cells[self.mesh.labels == label] for label in sorted(self.counts)]
        )
        self.assertTrue(np.array_equal(cells, own))
        self.assertTrue(np.allclose(read.points, self.mesh.points, rtol=1e-12, atol=1e-12))

    def test_gmsh(self):
        read = meshio.read(self.write("ball.msh", self.surface))
        self.check_cells(read)
        tags = {tuple(tag) for tag in map(tuple, read.field_data.values())}
        self.assertEqual({t for t, d in tags if d == 3}, set(self.counts))
        found = {label: 0 for label in self.counts}
        triangles = 0
        for block, data in zip(read.cells, read.cell_data["gmsh:physical"]):
            for tag in np.unique(data).tolist():
                if block.type == "tetra":
                    found[tag] += int((data == tag).sum())
            triangles += len(block.data) if block.type == "triangle" else 0
        self.assertEqual(found, self.counts)
        self.assertEqual(triangles, self.surface.GetNumberOfPolys())
        self.assertIn("ball_0", read.field_data)

    def test_abaqus(self):
        path = self.write("ball.inp", self.surface)
        read = meshio.read(path)
        self.check_cells(read)
        sizes = sorted(sum(len(part) for part in parts) for parts in read.cell_sets.values())
        self.assertEqual(sizes, sorted(self.counts.values()))
        self.assertTrue(any("_to_" in name for name in read.point_sets))
        self.assertNotIn("R3D3", path.read_text())

    def test_convert(self):
        path = self.write("volume.vtu")
        out = path.with_suffix(".msh")
        command = [sys.executable, "-m", "mlim.convert", str(path), str(out)]
        subprocess.run(command, check=True, timeout=120)
        self.check_cells(meshio.read(out))
        command[-1] = str(path.with_suffix(".stl"))
        done = subprocess.run(command, capture_output=True, text=True, timeout=120, check=False)
        self.assertEqual(done.returncode, 1)
        self.assertIn(".vtu, .msh or .inp", done.stderr)

    def test_wrong_surface(self):
        other = mlim.mesh(make_ball(), background=0)
        with self.assertRaises(ValueError):
            self.write("ball.msh", other)


if __name__ == "__main__":
    unittest.main()
