"""Label maps straight into the mesher, with default options.

    TestLabelMaps.py [--part=N/M] [NAME ...]

The maps are all *_labels.vti of the folder that the environment variable MLIM_DATA names; without it
the test is skipped (exit code 77). Names are files of that folder without .vti; --part leaves every
M-th map, from the N-th on. Every mesh has to have all labels with their ids, the volume of each label
of at least 1000 voxels within 3 % of its voxels, and a certificate without losses, and is audited
against the indicators that vtkMultiLabelIndicators makes. Some are compared with the mesh of those
indicators, which has to be the same. Figures are rows for Testing/Benchmarks/RESULTS.md;
seconds are the processor's, so that a busy machine does not count.
"""

import os
import resource
import subprocess
import sys
import time
from pathlib import Path

import numpy as np
from vtkmodules.util.numpy_support import vtk_to_numpy

from audit import NOISY_LIMITS, Surface, audit, enclosed_volumes, failures
from cell_field import CellField

SKIPPED = 77

# Meshed once more, from the indicators.
COMPARED = ("spheres8_labels", "polycrystal_damask20_labels", "brain_atlas_mni_thr25_labels")
VOLUME_VOXELS = 1000
MAX_VOLUME_DIFFERENCE = 0.03
# Of the process that makes the mesh, before the audit.
MAX_MEMORY_GB = 3.0
# Vertices that fail the disk condition: the target, and what is a regression.
TARGET_DISK_SHARE = 1e-4
MAX_DISK_SHARE = 5e-4
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


CERTIFICATE = ("LostLabelCount", "LostComponentCount", "OpenEdgeCount")

# Heading, format and value of the table's columns.
COLUMNS = (
    ("map", "{}", lambda f: f["name"]),
    ("labels", "{}", lambda f: f["labels"]),
    ("vertices", "{}", lambda f: f["points"]),
    ("triangles", "{}", lambda f: f["triangles"]),
    ("indicators s", "{:.1f}", lambda f: f["indicator_seconds"]),
    ("all s", "{:.1f}", lambda f: f["seconds"]),
    ("peak MB", "{:.0f}", lambda f: 1000 * f["memory"]),
    ("volumes", "{:.2%}", lambda f: f["worst_volume"]),
    ("open", "{}", lambda f: f["open_edges"] + f["incoherent_edges"]),
    ("lost", "{}", lambda f: sum(f["certificate"][:2])),
    ("disks", "{}", lambda f: f["failed_disks"]),
    ("off curves", "{}", lambda f: f["lines_off_curves"]),
    ("R/e > 1", "{}", lambda f: f["ratio_exceptions"]),
    ("per 10,000", "{:.2f}", lambda f: 1e4 * f["ratio_exception_share"]),
    ("normals", "{:.3%}", lambda f: f["normal_share"]),
    ("vertices on it", "{:.3%}", lambda f: f["vertex_share_off_plateaus"]),
    ("centres", "{:.3%}", lambda f: f["centre_share"]),
    ("crossings", "{:.3%}", lambda f: f["crossing_share"]),
)


def heading():
    names = " | ".join(name for name, _, _ in COLUMNS)
    return f"| {names} |\n|---|" + "---:|" * (len(COLUMNS) - 1)


def row(figures):
    cells = (form.format(value(figures)) for _, form, value in COLUMNS)
    return f"| {' | '.join(cells)} |"


def certificate_failures(figures):
    pairs = zip(CERTIFICATE, figures["certificate"])
    return [f"{name} is {count}" for name, count in pairs if count > 0]


def disk_failures(figures, limit):
    failed, points = figures["failed_disks"], figures["points"]
    return [f"{failed} of {points} disks fail"] if failed > limit * points else []


def are_same(first, second):
    return all(
        np.array_equal(vtk_to_numpy(a), vtk_to_numpy(b))
        for a, b in (
            (first.GetPoints().GetData(), second.GetPoints().GetData()),
            (first.GetPolys().GetConnectivityArray(), second.GetPolys().GetConnectivityArray()),
        )
    )


def make_indicators(image):
    import mlim

    indicators = mlim.vtkMultiLabelIndicators()
    indicators.SetInputData(image)
    indicators.Update()
    return indicators.GetOutput()


def run_case(path):
    """Figures, what is wrong, and which targets are missed."""
    import mlim

    image = mlim.read(path)
    start = time.process_time()
    surface = mlim.mesh(image, progress=False)
    seconds = time.process_time() - start
    memory = resource.getrusage(resource.RUSAGE_SELF).ru_maxrss * 1024 / 1e9
    mesh = Surface(surface)
    expected = voxel_volumes(image)
    found, worst = volume_failures(expected, enclosed_volumes(mesh, mesh.points.mean(axis=0)))
    found += label_failures(expected, mesh)
    if memory > MAX_MEMORY_GB:
        found.append(f"{memory:.2f} GB, more than {MAX_MEMORY_GB}")
    start = time.process_time()
    arrays = make_indicators(image)
    indicator_seconds = time.process_time() - start
    if path.stem in COMPARED and not are_same(surface, mlim.mesh(arrays, progress=False)):
        found.append("the mesh of the map is not that of its indicators")
    figures = audit(arrays, surface, float(value(surface, "FacetDistance")), CellField)
    figures.update(
        name=path.stem,
        labels=len(expected),
        seconds=seconds,
        memory=memory,
        worst_volume=worst,
        indicator_seconds=indicator_seconds,
        failed_disks=int(value(surface, "DiskFailureCount")),
        certificate=[int(value(surface, name)) for name in CERTIFICATE],
    )
    found += certificate_failures(figures) + disk_failures(figures, MAX_DISK_SHARE)
    found += failures(figures, **NOISY_LIMITS)
    targets = failures(figures) + disk_failures(figures, TARGET_DISK_SHARE)
    return figures, found, [text for text in targets if text not in found]


def report_case(path):
    figures, found, missed = run_case(path)
    print(row(figures), flush=True)
    for text in found:
        print(f"  FAILED: {text}", flush=True)
    for text in missed:
        print(f"  target missed: {text}", flush=True)
    return 1 if found else 0


def choose(folder, words):
    """Paths of the maps, the large ones dealt out evenly to the parts."""
    names = [word for word in words if not word.startswith("--part=")]
    paths = [folder / f"{name}.vti" for name in names] or sorted(
        folder.glob("*_labels.vti"), key=lambda path: -path.stat().st_size
    )
    for word in words:
        if word.startswith("--part="):
            part, parts = map(int, word.removeprefix("--part=").split("/"))
            paths = paths[part - 1 :: parts]
    return paths


def main(words):
    folder = os.environ.get("MLIM_DATA")
    if not (folder and Path(folder).is_dir()):
        print("skipped: MLIM_DATA names no folder of images")
        return SKIPPED
    paths = choose(Path(folder), words)
    if not paths:
        print(f"skipped: no label maps in {folder}")
        return SKIPPED
    if [path.stem for path in paths] == words and len(words) == 1:
        return report_case(paths[0])
    print(heading(), flush=True)
    # A process each, whose memory is the map's own.
    failed = [subprocess.call([sys.executable, __file__, path.stem]) for path in paths]
    print(f"{failed.count(0)} of {len(paths)} maps passed")
    return 1 if any(failed) else 0


if __name__ == "__main__":
    sys.exit(main(sys.argv[1:]))
