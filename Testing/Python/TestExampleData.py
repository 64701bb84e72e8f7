"""The committed example images are what the generator writes, and their meshes pass the audit."""

import sys
import unittest
from pathlib import Path

import numpy as np

import mlim
from audit import NOISY_LIMITS, audit, check
from naive_field import NaiveField
from TestRealData import option_used, read_image

EXAMPLE_DATA = Path(__file__).resolve().parents[2] / "ExampleData"
sys.path.insert(0, str(EXAMPLE_DATA))

import generate  # noqa: E402

IMAGES = {"spheres": generate.make_spheres, "tissue": generate.make_tissue}


class TestExampleData(unittest.TestCase):
    def test_generator(self):
        for name, make in IMAGES.items():
            committed = NaiveField(read_image(EXAMPLE_DATA / f"{name}.vti"))
            made = NaiveField(make())
            self.assertEqual(committed.names, made.names)
            self.assertEqual(committed.start.tolist(), made.start.tolist())
            for before, after in zip(committed.values, made.values):
                # The last digit may differ where another processor rounds sqrt or exp otherwise.
                step = 1 if before.dtype == np.uint8 else generate.SPHERES_STEP
                self.assertLessEqual(np.abs(before.astype(float) - after).max(), step)

    def test_tissue_adds_up(self):
        field = NaiveField(read_image(EXAMPLE_DATA / "tissue.vti"))
        total = sum(values.astype(int) for values in field.values)
        self.assertTrue((total == generate.TISSUE_TOTAL).all())

    def test_meshes(self):
        for name in IMAGES:
            with self.subTest(name):
                image = read_image(EXAMPLE_DATA / f"{name}.vti")
                surface = mlim.mesh(image)
                limits = NOISY_LIMITS if name == "tissue" else {}
                check(audit(image, surface, option_used(surface, "FacetDistance")), **limits)


if __name__ == "__main__":
    unittest.main()
