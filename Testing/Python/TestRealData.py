"""Real images through the whole path, each mesh audited from the outside.

    TestRealData.py [NAME[@FACET_SIZE] ...]

The images are looked for in the folder that the environment variable MLIM_DATA names; without it
the test is skipped (exit code 77). Names are files of that folder without .vti, or paths; a facet
size is in units of the smallest spacing, and 0 or none means the default. Without names all cases.
"""

import os
import sys
import time
from pathlib import Path

from vtkmodules.util.numpy_support import vtk_to_numpy
from vtkmodules.vtkIOXML import vtkXMLImageDataReader

from audit import NOISY_LIMITS, audit, failures

SKIPPED = 77

# FacetSize, in the smallest spacing, that gives the brain atlas as many vertices as in the paper.
BRAIN_ATLAS = "brain_atlas_mni_prob"
BRAIN_FACET_SIZE = 7.0
BRAIN_VERTICES = (30000, 45000)
CASES = (
    (BRAIN_ATLAS, BRAIN_FACET_SIZE),
    (BRAIN_ATLAS, BRAIN_FACET_SIZE / 1.5),
    (BRAIN_ATLAS, BRAIN_FACET_SIZE * 3),
    ("spheres8_indicators", 0),
    ("cleaver_spheres_indicators", 0),
    ("soft_brain_ants19_prob", 0),
    ("torso_ct_indicators", 0),
    ("polycrystal_damask20_indicators", 0),
    ("thalamus_prob", 0),
    ("fluids3_synthetic_prob", 0),
)

# Heading, format and value of the table's columns.
COLUMNS = (
    ("image", "{:32s}", lambda f: f["name"]),
    ("size", "{:5.2f}", lambda f: f["facet_size"] / f["spacing"]),
    ("vertices", "{:8d}", lambda f: f["points"]),
    ("triangles", "{:9d}", lambda f: f["triangles"]),
    ("curve e.", "{:8d}", lambda f: f["curve_edges"]),
    ("junct.", "{:6d}", lambda f: f["junctions"]),
    ("mesh s", "{:6.2f}", lambda f: f["mesh_seconds"]),
    ("audit s", "{:7.1f}", lambda f: f["audit_seconds"]),
    ("open", "{:4d}", lambda f: f["open_edges"] + f["incoherent_edges"]),
    ("contac", "{:6d}", lambda f: f["contact_lines"]),
    ("off c.", "{:6d}", lambda f: f["lines_off_curves"]),
    ("disks", "{:5d}", lambda f: f["failed_disks"]),
    ("2-tri", "{:5d}", lambda f: f["curve_edges_with_two_triangles"]),
    ("bad el.", "{:7d}", lambda f: f["degenerate"] + f["duplicate_triangles"]),
    ("normals", "{:7.3%}", lambda f: f["normal_share"]),
    ("lost", "{:4d}", lambda f: len(f["lost_labels"])),
    ("R/e max", "{:7.3f}", lambda f: f["max_ratio"]),
    (">1", "{:5d}", lambda f: f["ratio_exceptions"]),
    ("ball max", "{:8.2f}", lambda f: f["max_ball_ratio"]),
    ("mean", "{:5.3f}", lambda f: f["mean_ratio"]),
    ("angle", "{:5.2f}", lambda f: f["min_angle"]),
    ("vertex", "{:7.3%}", lambda f: f["vertex_share"]),
    ("platea", "{:6d}", lambda f: f["far_vertices_on_plateaus"]),
    ("centre", "{:7.3%}", lambda f: f["centre_share"]),
    ("crossing", "{:8.3%}", lambda f: f["crossing_share"]),
    ("volume", "{:7.3%}", lambda f: f["max_volume_difference"]),
    ("counted", "{:7.3%}", lambda f: f["max_counted_volume_difference"]),
)


def width(form):
    """The width that a format spells out."""
    return int("".join(c for c in form[2:].split(".")[0] if c.isdigit()))


def heading():
    return " ".join(title.rjust(width(form)) for title, form, _ in COLUMNS)


def row(figures):
    return " ".join(form.format(value(figures)) for _, form, value in COLUMNS)


def read_image(path):
    reader = vtkXMLImageDataReader()
    reader.SetFileName(str(path))
    reader.Update()
    if reader.GetOutput().GetNumberOfPoints() == 0:
        raise OSError(f"cannot read {path}")
    return reader.GetOutput()


def option_used(surface, name):
    """A length that the mesher used, from the output's field data."""
    array = surface.GetFieldData().GetArray(name)
    if array is None or array.GetNumberOfTuples() == 0:
        raise AssertionError(f"the output's field data have no {name}")
    return float(vtk_to_numpy(array).ravel()[0])


def run_case(path, facet_size_spacings):
    import mlim

    image = read_image(path)
    options = {}
    if facet_size_spacings > 0:
        options["facet_size"] = facet_size_spacings * min(image.GetSpacing())
    start = time.perf_counter()
    surface = mlim.mesh(image, **options)
    mesh_seconds = time.perf_counter() - start
    start = time.perf_counter()
    figures = audit(image, surface, option_used(surface, "FacetDistance"))
    figures["audit_seconds"] = time.perf_counter() - start
    figures["mesh_seconds"] = mesh_seconds
    figures["facet_size"] = option_used(surface, "FacetSize")
    figures["failed_disks"] = int(option_used(surface, "DiskFailureCount"))
    figures["named_disks"] = named_disks(surface)
    figures["name"] = path.stem
    return figures


def named_disks(surface):
    """Of the vertices that fail the disk condition, those whose place and type are a point's of the mesh."""
    arrays = surface.GetFieldData()
    places = vtk_to_numpy(arrays.GetArray("DiskFailurePoints")).reshape(-1, 3)
    types = vtk_to_numpy(arrays.GetArray("DiskFailureTypes"))
    points = vtk_to_numpy(surface.GetPoints().GetData())
    node_types = vtk_to_numpy(surface.GetPointData().GetArray("NodeType"))
    return sum(
        bool(((points == place).all(axis=1) & (node_types == kind)).any())
        for place, kind in zip(places, types)
    )


def disk_failures(figures):
    """Vertices that fail the disk condition: at most 1 in 10,000, each named by place and type."""
    failed, points = figures["failed_disks"], figures["points"]
    found = [f"{failed} of {points} disks fail"] if failed > points / 10000 else []
    if figures["named_disks"] != failed:
        found.append(f"{figures['named_disks']} of {failed} disks that fail are named by their place")
    return found


def vertex_count_failures(figures, facet_size_spacings):
    low, high = BRAIN_VERTICES
    is_reference = figures["name"] == BRAIN_ATLAS and facet_size_spacings == BRAIN_FACET_SIZE
    if is_reference and not low <= figures["points"] <= high:
        return [f"{figures['points']} vertices, not {low} to {high}"]
    return []


def parse(word):
    name, _, size = word.partition("@")
    return name, float(size or 0)


def locate(name, folder):
    path = Path(name if name.endswith(".vti") else f"{name}.vti")
    return path if path.exists() or folder is None else Path(folder) / path


def main(words):
    folder = os.environ.get("MLIM_DATA")
    cases = [parse(word) for word in words] or CASES
    if not words and not (folder and Path(folder).is_dir()):
        print("skipped: MLIM_DATA names no folder of images")
        return SKIPPED
    print(heading(), flush=True)
    failed = 0
    for name, facet_size in cases:
        try:
            figures = run_case(locate(name, folder), facet_size)
            found = failures(figures, **NOISY_LIMITS) + vertex_count_failures(figures, facet_size)
            missed = [text for text in failures(figures) if text not in found]
            print(row(figures), flush=True)
        except (AssertionError, OSError, RuntimeError, ValueError) as error:
            figures, found, missed = None, [str(error)], []
            print(name, flush=True)
        if words and figures is not None:
            for key, value in figures.items():
                print(f"    {key}: {value}")
        for text in found:
            print(f"  FAILED: {text}", flush=True)
        for text in missed:
            print(f"  target missed: {text}", flush=True)
        failed += bool(found)
    print(f"{len(cases) - failed} of {len(cases)} meshes passed")
    return 1 if failed else 0


if __name__ == "__main__":
    sys.exit(main(sys.argv[1:]))
