"""The package mlim as it was installed or built, and the Python example with it."""

import os
import subprocess
import sys
import tempfile
import unittest
from pathlib import Path

import numpy as np
from vtkmodules.util.numpy_support import vtk_to_numpy
from vtkmodules.vtkFiltersCore import vtkFeatureEdges, vtkMassProperties
from vtkmodules.vtkIOGeometry import vtkSTLReader
from vtkmodules.vtkIOXML import vtkXMLPolyDataReader

import mlim

SOURCE = Path(__file__).resolve().parents[2]
SPHERES = SOURCE / "ExampleData" / "spheres.vti"
EXAMPLE = SOURCE / "Examples" / "Python" / "mesh_labels.py"
REGIONS = 8


def read(reader, path):
    reader.SetFileName(str(path))
    reader.Update()
    return reader.GetOutput()


class TestExamples(unittest.TestCase):
    def test_package_lies_where_it_should(self):
        self.assertTrue(mlim.__file__.startswith(os.environ["MLIM_ROOT"] + os.sep), mlim.__file__)
        self.assertTrue((Path(mlim.__file__).parent / "py.typed").exists())

    def test_pipeline_with_readers_and_writers(self):
        with tempfile.TemporaryDirectory() as folder:
            subprocess.run([sys.executable, str(EXAMPLE), str(SPHERES), folder, "0.1"], check=True)
            surface = read(vtkXMLPolyDataReader(), Path(folder) / "surface.vtp")
            self.assertEqual(surface.GetFieldData().GetArray("LostLabelCount").GetValue(0), 0)
            for name in ("curves", "balls"):
                data = read(vtkXMLPolyDataReader(), Path(folder) / f"{name}.vtp")
                self.assertGreater(data.GetNumberOfLines(), 0)
            volumes = vtk_to_numpy(surface.GetFieldData().GetArray("LabelVolumes"))
            ids = vtk_to_numpy(surface.GetFieldData().GetArray("LabelIds"))
            for region in range(1, REGIONS + 1):
                boundary = read(vtkSTLReader(), Path(folder) / f"region_{region}.stl")
                self.check_closed(boundary, volumes[np.flatnonzero(ids == region)[0]])

    def check_closed(self, boundary, volume):
        edges = vtkFeatureEdges()
        edges.SetInputData(boundary)
        edges.FeatureEdgesOff()
        edges.Update()
        self.assertEqual(edges.GetOutput().GetNumberOfLines(), 0)
        mass = vtkMassProperties()
        mass.SetInputData(boundary)
        # STL holds single precision.
        self.assertAlmostEqual(mass.GetVolume() / volume, 1, places=4)


if __name__ == "__main__":
    unittest.main()
