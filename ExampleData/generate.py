#!/usr/bin/env python3
"""Writes the synthetic example images beside this file.

spheres.vti  eight overlapping spheres: one signed distance r - |x - c| a sphere, and a background
             of 0, so that a point belongs to the sphere in which it lies deepest. Neighbours meet
             in curves, three spheres and the background in junctions.
tissue.vti   soft labels: uint8 arrays that add up to 255 at every point, on a grid with unequal
             spacing, an origin and an extent that do not start at 0. The vessel leaves the box.

    python3 ExampleData/generate.py [FOLDER]
"""

import sys
from pathlib import Path

import numpy as np
from vtkmodules.util.numpy_support import numpy_to_vtk
from vtkmodules.vtkCommonDataModel import vtkImageData
from vtkmodules.vtkIOXML import vtkXMLImageDataWriter

# Centres of the cube's corners, moved apart by hand, and radii: neighbours overlap along the edges
# and the face diagonals of the cube, and a closed piece of background is left in its middle.
SPHERES = (
    ((-0.36, -0.33, -0.35), 0.49),
    ((0.33, -0.37, -0.34), 0.53),
    ((-0.32, 0.36, -0.37), 0.51),
    ((0.37, 0.33, -0.31), 0.47),
    ((-0.35, -0.36, 0.33), 0.52),
    ((0.35, -0.32, 0.37), 0.48),
    ((-0.37, 0.33, 0.34), 0.50),
    ((0.32, 0.37, 0.35), 0.53),
)
SPHERES_POINTS = 49
# Distances are cut off this far outside a sphere, where they decide nothing: cells that a sphere
# may own have all their corners nearer than this. In units of the spacing.
SPHERES_BAND = 4.0
# Values are multiples of this, so that they compress: 0.0015 spacings, far below any tolerance.
SPHERES_STEP = 2.0**-14

TISSUE_POINTS = (64, 56, 40)
TISSUE_SPACING = (0.8, 0.8, 1.25)
TISSUE_ORIGIN = (-30.0, 12.5, 100.0)
TISSUE_EXTENT_START = (5, -3, 2)
# Width over which one probability gives way to the next, in world units: about 2 points.
TISSUE_SOFTNESS = 0.6
# Sum of the probabilities at every point.
TISSUE_TOTAL = 255


def grid_coordinates(points, spacing, centre):
    """Coordinates x, y, z of the grid points, relative to `centre`; z varies slowest."""
    axes = [
        np.arange(n) * s + (c - 0.5 * (n - 1) * s) for n, s, c in zip(points, spacing, centre)
    ]
    z, y, x = np.meshgrid(axes[2], axes[1], axes[0], indexing="ij")
    return x, y, z


def make_image(spacing, origin, extent_start, arrays):
    """The image with one point array for each (name, values indexed z, y, x)."""
    depth, height, width = arrays[0][1].shape
    i, j, k = extent_start
    image = vtkImageData()
    image.SetExtent(i, i + width - 1, j, j + height - 1, k, k + depth - 1)
    image.SetSpacing(spacing)
    image.SetOrigin(origin)
    for name, values in arrays:
        array = numpy_to_vtk(np.ascontiguousarray(values).ravel(), deep=True)
        array.SetName(name)
        image.GetPointData().AddArray(array)
    return image


def make_spheres():
    spacing = 2.0 / (SPHERES_POINTS - 1)
    x, y, z = grid_coordinates((SPHERES_POINTS,) * 3, (spacing,) * 3, (0, 0, 0))
    arrays = [("background", np.zeros(x.shape, np.float32))]
    for index, (centre, radius) in enumerate(SPHERES, start=1):
        distance = np.sqrt(
            (x - centre[0]) ** 2 + (y - centre[1]) ** 2 + (z - centre[2]) ** 2
        )
        depth = np.maximum(radius - distance, -SPHERES_BAND * spacing)
        rounded = np.rint(depth / SPHERES_STEP) * SPHERES_STEP
        arrays.append((f"sphere{index}", rounded.astype(np.float32)))
    return make_image((spacing,) * 3, (-1, -1, -1), (0, 0, 0), arrays)


def ellipsoid(x, y, z, centre, radii):
    """About the signed distance to an ellipsoid, positive inside."""
    u = np.sqrt(sum(((p - c) / r) ** 2 for p, c, r in zip((x, y, z), centre, radii)))
    return (1.0 - u) * min(radii)


def tissue_depths(x, y, z):
    """How deep each point lies in each region, in world units; the names give the order."""
    waves = 0.9 * np.sin(0.33 * x + 0.4) * np.sin(0.36 * y) * np.cos(0.29 * z)
    outer = ellipsoid(x, y, z, (0, 0, 0), (21.5, 18.5, 19.5)) + waves
    inner = ellipsoid(x, y, z, (0, 0, 0), (16.0, 13.5, 14.5)) + 1.6 * waves
    nucleus_left = ellipsoid(x, y, z, (-6.2, 0.8, -1.0), (6.6, 6.0, 7.5))
    nucleus_right = ellipsoid(x, y, z, (5.8, -0.6, 1.5), (7.0, 6.4, 6.5))
    bend = np.hypot(x - 9.0 - 3.0 * np.sin(0.12 * z), y - 6.5 - 2.0 * np.cos(0.1 * z))
    vessel = 3.4 - bend
    nuclei = np.maximum(nucleus_left, nucleus_right)
    depths = {
        "background": -outer,
        "cortex": np.minimum(outer, -inner),
        "core": np.minimum(inner, -nuclei),
        "nucleus_left": np.minimum(nucleus_left, inner),
        "nucleus_right": np.minimum(nucleus_right, inner),
    }
    # The vessel takes its place from all others.
    depths = {name: np.minimum(depth, -vessel) for name, depth in depths.items()}
    depths["vessel"] = vessel
    return depths


def largest_remainder(shares, total):
    """Whole numbers near `shares` (regions first) that add up to `total` at every point."""
    floors = np.floor(shares)
    missing = total - floors.sum(axis=0)
    rank = np.argsort(np.argsort(floors - shares, axis=0, kind="stable"), axis=0, kind="stable")
    return (floors + (rank < missing)).astype(np.uint8)


def make_tissue():
    x, y, z = grid_coordinates(TISSUE_POINTS, TISSUE_SPACING, (0, 0, 0))
    depths = tissue_depths(x, y, z)
    stack = np.stack(list(depths.values())) / TISSUE_SOFTNESS
    weights = np.exp(stack - stack.max(axis=0))
    # Rounded, so that the last bits of exp() do not decide how the shares become whole numbers.
    shares = np.round(TISSUE_TOTAL * weights / weights.sum(axis=0), 6)
    values = largest_remainder(shares, TISSUE_TOTAL)
    arrays = list(zip(depths, values))
    return make_image(TISSUE_SPACING, TISSUE_ORIGIN, TISSUE_EXTENT_START, arrays)


def write(image, path):
    writer = vtkXMLImageDataWriter()
    writer.SetFileName(str(path))
    writer.SetInputData(image)
    # Inline: with a newer version of their XML parser, expat, ParaView 5.11 and VTK 9.2 cannot read
    # appended data.
    writer.SetDataModeToBinary()
    writer.SetCompressorTypeToZLib()
    writer.SetCompressionLevel(9)
    if not writer.Write():
        raise OSError(f"cannot write {path}")
    print(f"{path}: {path.stat().st_size} bytes")


def main():
    folder = Path(sys.argv[1]) if len(sys.argv) > 1 else Path(__file__).resolve().parent
    folder.mkdir(parents=True, exist_ok=True)
    write(make_spheres(), folder / "spheres.vti")
    write(make_tissue(), folder / "tissue.vti")


if __name__ == "__main__":
    main()
