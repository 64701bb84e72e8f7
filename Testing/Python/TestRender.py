"""The rendering script draws what it says, judged by the colours of the picture."""

import os
import subprocess
import sys
import tempfile
import unittest
from pathlib import Path

import numpy as np
from vtkmodules.util.numpy_support import vtk_to_numpy
from vtkmodules.vtkIOImage import vtkPNGReader
from vtkmodules.vtkIOXML import vtkXMLPolyDataWriter

import mlim
from TestAudit import two_boxes_image, two_boxes_surface
from TestPipeline import make_image

SKIPPED = 77
SCRIPT = Path(__file__).resolve().parents[2] / "ExampleData" / "render.py"


def render(folder, *options):
    """The picture's pixels (rows, columns, 3) from 0 to 1."""
    surface, picture = Path(folder) / "boxes.vtp", Path(folder) / "boxes.png"
    writer = vtkXMLPolyDataWriter()
    writer.SetFileName(str(surface))
    writer.SetInputData(two_boxes_surface(two_boxes_image()))
    writer.Write()
    command = [sys.executable, str(SCRIPT), str(surface), str(picture), "--width", "320", *options]
    subprocess.run(command, check=True, timeout=120)
    reader = vtkPNGReader()
    reader.SetFileName(str(picture))
    reader.Update()
    width, height, _ = reader.GetOutput().GetDimensions()
    pixels = vtk_to_numpy(reader.GetOutput().GetPointData().GetScalars())
    return pixels[:, :3].reshape(height, width, 3) / 255.0


def shares(pixels):
    """Shares of the pixels that are bluish (region 1), orange (region 2) and white."""
    red, blue = pixels[..., 0], pixels[..., 2]
    white = (pixels > 0.99).all(axis=-1)
    return (blue > red + 0.15).mean(), (red > blue + 0.25).mean(), white.mean()


class TestRender(unittest.TestCase):
    def test_views(self):
        with tempfile.TemporaryDirectory() as folder:
            whole = render(folder, "--view", "whole")
            self.assertEqual(whole.shape, (240, 320, 3))
            blue, orange, white = shares(whole)
            self.assertGreater(blue, 0.1)
            self.assertGreater(orange, 0.1)
            self.assertGreater(white, 0.1)
            cut = render(folder, "--view", "cutaway", "--remove", "2")
            self.assertGreater(shares(cut)[0], 0.1)
            self.assertLess(shares(cut)[1], 0.01)
            both = render(folder)
            self.assertEqual(both.shape, (160, 320, 3))
            self.assertTrue(np.ptp(both[:, :160]) > 0.5 and np.ptp(both[:, 160:]) > 0.5)


class TestRenderVolume(unittest.TestCase):
    def test_cut(self):
        """Both regions' colours show, and more of the ball than of nothing."""
        with tempfile.TemporaryDirectory() as folder:
            _, volume = mlim.mesh(make_image(), volume=True)
            path, picture = Path(folder) / "volume.vtu", Path(folder) / "volume.png"
            mlim.write_volume(volume, path)
            script = SCRIPT.with_name("render_volume.py")
            command = [sys.executable, str(script), str(picture), str(path), str(path)]
            subprocess.run([*command, "--width", "400"], check=True, timeout=120)
            reader = vtkPNGReader()
            reader.SetFileName(str(picture))
            reader.Update()
            self.assertEqual(reader.GetOutput().GetDimensions()[:2], (400, 200))
            pixels = vtk_to_numpy(reader.GetOutput().GetPointData().GetScalars())[:, :3] / 255.0
            bluish = (pixels[:, 2] > pixels[:, 0] + 0.1).mean()
            orange = (pixels[:, 0] > pixels[:, 2] + 0.15).mean()
            self.assertGreater(bluish, 0.03)
            self.assertGreater(orange, 0.03)
            self.assertGreater((pixels > 0.99).all(axis=1).mean(), 0.1)


if __name__ == "__main__":
    if not os.environ.get("DISPLAY"):
        print("skipped: no display")
        sys.exit(SKIPPED)
    unittest.main()
