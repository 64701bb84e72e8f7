"""The example script with the installed plugin: its mesh, its picture and its state file."""

import os
import subprocess
import sys
import tempfile
import unittest

from paraview import simple
from paraview.vtk.util.numpy_support import vtk_to_numpy
from paraview.vtk.vtkIOImage import vtkPNGReader

import plugin

# Share of the picture's pixels that differ from the background.
MIN_DRAWN_SHARE = 0.15


class TestExample(unittest.TestCase):
    def test_example(self):
        with tempfile.TemporaryDirectory() as folder:
            command = [os.environ["MLIM_PVPYTHON"], script, installed, plugin.SPHERES, folder, "0.1"]
            subprocess.run(command, check=True, timeout=120)
            reader = simple.XMLPolyDataReader(FileName=[os.path.join(folder, "surface.vtp")])
            surface = plugin.fetch(reader)
            self.assertGreater(surface.GetNumberOfPolys(), 1000)
            self.assertGreater(surface.GetNumberOfLines(), 0)
            picture = vtkPNGReader()
            picture.SetFileName(os.path.join(folder, "mesh.png"))
            picture.Update()
            pixels = vtk_to_numpy(picture.GetOutput().GetPointData().GetScalars())[:, :3]
            self.assertGreater((abs(pixels.astype(int) - pixels[0]).max(axis=1) > 8).mean(), MIN_DRAWN_SHARE)
            self.assertTrue(os.path.exists(os.path.join(folder, "mesh.pvsm")))


if __name__ == "__main__":
    script, installed = sys.argv[1:3]
    unittest.main(argv=sys.argv[:1])
