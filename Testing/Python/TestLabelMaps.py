"""Label maps straight into the mesher, with default options.

    TestLabelMaps.py [NAME ...]

The maps are looked for in the folder that the environment variable MLIM_DATA names; without it the
test is skipped (exit code 77). Names are files of that folder without .vti; without names a choice
that takes about a minute. Every mesh has to have all labels with their ids, the volume of each label
of at least 1000 voxels within 3 % of its voxels, and a certificate without losses. Some are audited
against the indicators that vtkMultiLabelIndicators makes, which have to give the same mesh.
"""

import os
import resource
import sys
import time
from pathlib import Path

import numpy as np
from vtkmodules.util.numpy_support import vtk_to_numpy

from audit import NOISY_LIMITS, Surface, audit, enclosed_volumes, failures

SKIPPED = 77

# Name, and whether the mesh is audited as well: that needs all indicators at once.
CASES = (
    ("brain_aal116_labels", False),
    ("spheres8_labels", True),
    ("polycrystal_damask20_labels", True),
    ("cells_ovule_labels", False),
    ("potts64_periodic_labels", False),
    ("fruit_orange_synthetic_labels", False),
)
VOLUME_VOXELS = 1000
MAX_VOLUME_DIFFERENCE = 0.03
# Of the whole process, all meshes so far included.
MAX_MEMORY_GB = 3.0
BACKGROUND = 0


def voxel_volumes(image):
    """{id: (voxels, volume)}; points on the box's faces, edges and corners weigh 1/2, 1/4, 1/8."""
    ids = vtk_to_numpy(image.GetPointData().GetArray(0)).reshape(image.GetDimensions()[::-1])
    weights = [np.ones(n) for n in ids.shape]
    for axis_weights in weights:
        axis_weights[0] = axis_weights[-1] = 0.5
    weight = weights[0][:, None, None] * weights[1][None, :, None] * weights[2][None, None, :]
    found, where = np.unique(ids, return_inverse=True)
    where = where.ravel()
    counts = np.bincount(where)
    volumes = np.bincount(where, weight.ravel()) * np.prod(image.GetSpacing())
    return {int(i): (int(c), float(v)) for i, c, v in zip(found, counts, volumes)}


def value(surface, name):
    return vtk_to_numpy(surface.GetFieldData().GetArray(name)).ravel()[0]


def volume_failures(expected, volumes):
    found, worst = [], 0.0
    for label, (voxels, volume) in expected.items():
        difference = volumes.get(label, 0.0) / volume - 1
        if label == BACKGROUND or voxels < VOLUME_VOXELS:
            continue
        worst = max(worst, abs(difference))
        if abs(difference) > MAX_VOLUME_DIFFERENCE:
            found.append(f"label {label} of {voxels} voxels has {difference:+.2%} of their volume")
    return found, worst


def label_failures(expected, mesh):
    present = set(np.unique(mesh.labels).tolist()) | {BACKGROUND}
    wanted = set(expected) | {BACKGROUND}
    found = [f"labels lost: {sorted(wanted - present)}"] if wanted - present else []
    return found + ([f"labels made up: {sorted(present - wanted)}"] if present - wanted else [])


def certificate_failures(surface):
    names = ("LostLabelCount", "LostComponentCount", "OpenEdgeCount")
    return [f"{name} is {value(surface, name)}" for name in names if value(surface, name) > 0]


def are_same(first, second):
    return all(
        np.array_equal(vtk_to_numpy(a), vtk_to_numpy(b))
        for a, b in (
            (first.GetPoints().GetData(), second.GetPoints().GetData()),
            (first.GetPolys().GetConnectivityArray(), second.GetPolys().GetConnectivityArray()),
        )
    )


def audit_failures(image, surface):
    import mlim

    indicators = mlim.vtkMultiLabelIndicators()
    indicators.SetInputData(image)
    indicators.Update()
    arrays = indicators.GetOutput()
    if not are_same(surface, mlim.mesh(arrays, progress=False)):
        return ["the mesh of the map is not that of its indicators"]
    figures = audit(arrays, surface, float(value(surface, "FacetDistance")))
    return failures(figures, **NOISY_LIMITS)


def run_case(path, is_audited):
    import mlim

    image = mlim.read(path)
    start = time.perf_counter()
    surface = mlim.mesh(image, progress=False)
    seconds = time.perf_counter() - start
    mesh = Surface(surface)
    expected = voxel_volumes(image)
    found, worst = volume_failures(
        expected, enclosed_volumes(mesh, mesh.points.mean(axis=0))
    )
    found += label_failures(expected, mesh) + certificate_failures(surface)
    memory = resource.getrusage(resource.RUSAGE_SELF).ru_maxrss / 2**20
    if memory > MAX_MEMORY_GB:
        found.append(f"{memory:.2f} GB, more than {MAX_MEMORY_GB}")
    if is_audited:
        found += audit_failures(image, surface)
    print(
        f"{path.stem:32s} {len(expected):4d} labels {value(surface, 'VertexCount'):8d} vertices "
        f"{seconds:6.1f} s, {value(surface, 'TimeIndicators'):5.1f} s of it indicators, "
        f"{memory:5.2f} GB, volumes within {worst:.2%}, "
        f"{value(surface, 'DiskFailureCount')} vertices off the disk condition",
        flush=True,
    )
    return found


def main(names):
    folder = os.environ.get("MLIM_DATA")
    if not (folder and Path(folder).is_dir()):
        print("skipped: MLIM_DATA names no folder of images")
        return SKIPPED
    failed = 0
    for name, is_audited in [(n, False) for n in names] or CASES:
        found = run_case(Path(folder) / f"{name}.vti", is_audited)
        for text in found:
            print(f"  FAILED: {text}", flush=True)
        failed += bool(found)
    return 1 if failed else 0


if __name__ == "__main__":
    sys.exit(main(sys.argv[1:]))
