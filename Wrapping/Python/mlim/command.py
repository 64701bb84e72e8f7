"""The command line: python3 -m mlim."""

from __future__ import annotations

import argparse
import contextlib
import inspect
import sys
import warnings

from . import meshing
from .exporting import write_volume
from .readers import known_endings, read
from .reporting import report
from .running import MeshError, MeshWarning
from .version import __version__
from .writers import check_name, write

EXIT_OK = 0
EXIT_FAILED = 1
EXIT_USAGE = 2
EXIT_INTERRUPTED = 130  # as a shell says it of Ctrl-C

# Options of mlim.mesh that are numbers or words, and their help. Defaults are those of mlim.mesh.
_OPTIONS = {
    "facet_size": "density: bound on the radius of a triangle's surface Delaunay ball; "
    "0: twice the spacing",
    "facet_distance": "bound on the distance of triangles from the interface; 0: facet size / 8",
    "facet_radius_edge_ratio": "bound on circumradius / shortest edge; 1: angles of 30 degrees",
    "volume_tolerance": "relative difference of volume that large regions may have; 0: off",
    "edge_size": "largest distance of neighbours on a curve; 0: facet size",
    "ball_radius_scale": "scales the first radii of the protecting balls, 0.01 to 1",
    "crossing_tolerance": "length at which the search of a crossing stops; 0: spacing / 1e6",
    "junction_merge_tolerance": "junctions closer than this become one; 0: spacing / 4",
    "oracle_mode": "exact finds every crossing, bisection is the paper's",
    "tie_breaking": "on plateaus of integer data",
    "unseen_labels": "films and specks that no voxel sees: keep or drop them",
    "cell_size": "of the volume: bound on the circumradius of tetrahedra; 0: twice the facet size",
    "cell_radius_edge_ratio": "of the volume: bound on circumradius / shortest edge",
    "minimum_component_voxels": "smaller components need not be in the mesh",
    "vertex_limit": "refinement stops there",
}
_CHOICES = {
    "oracle_mode": ("exact", "bisection"),
    "tie_breaking": ("smooth", "lowest_index"),
    "unseen_labels": ("keep", "drop"),
}
_WHOLE_NUMBERS = ("minimum_component_voxels", "vertex_limit")


def main(words: list[str] | None = None) -> int:
    """Runs the command line; the result is the exit code."""
    try:
        options = _parser().parse_args(words)
    except SystemExit as leave:  # argparse has said why
        return int(leave.code or 0)
    try:
        for name in (options.output, options.curves, options.balls):
            if name is not None:
                check_name(name)
        with _warnings_as_lines():
            _run(options)
    except (MeshError, OSError, ValueError, ImportError, MemoryError) as error:
        print(f"mlim: {str(error) or 'there is not enough memory'}", file=sys.stderr)
        return EXIT_FAILED
    except KeyboardInterrupt:
        print("mlim: interrupted, nothing is written", file=sys.stderr)
        return EXIT_INTERRUPTED
    return EXIT_OK


def _parser() -> argparse.ArgumentParser:
    parser = argparse.ArgumentParser(
        prog="python3 -m mlim",
        description="Meshes all interfaces between the regions of a multi-label image as one "
        "consistent triangle surface. Lengths are in the image's world units.",
        epilog="Images: " + " ".join(known_endings()) + ", folders of slices, and other files that "
        "VTK's image readers recognise. Exit codes: 0 done; 1 the image cannot be read or meshed, "
        "with a sentence on stderr; 2 wrong usage; 130 interrupted.",
    )
    parser.add_argument("input", metavar="IMAGE", help="one array for each label")
    parser.add_argument(
        "-o", "--output", required=True, metavar="FILE", help="surface: .vtp .vtk .stl .ply .obj"
    )
    parser.add_argument(
        "--volume", metavar="FILE", help="also fill the regions with tetrahedra: .vtu .msh .inp"
    )
    parser.add_argument("--curves", metavar="FILE", help="also write the curves")
    parser.add_argument("--balls", metavar="FILE", help="also write the protecting balls")
    parser.add_argument(
        "--arrays", nargs="+", metavar="NAME", help="the arrays to use, one a label; default: all"
    )
    parser.add_argument(
        "--background",
        type=_background,
        metavar="NAME|NUMBER|complement",
        help="the background's array (default: the one called background), or a label more with "
        "this number everywhere, or with what the others leave of the largest sum",
    )
    defaults = inspect.signature(meshing.mesh).parameters
    group = parser.add_argument_group("options of the mesh")
    for name, text in _OPTIONS.items():
        default = defaults[name].default
        shown = "" if default is None else " (default: %(default)s)"
        if name in _CHOICES:
            more = {"choices": _CHOICES[name]}
        else:
            more = {"type": int if name in _WHOLE_NUMBERS else float, "metavar": "NUMBER"}
        flag = "--" + name.replace("_", "-")
        group.add_argument(flag, default=default, help=text + shown, **more)
    group.add_argument("--no-caps", action="store_true", help="leave regions open at the box")
    group.add_argument(
        "--no-curves", action="store_true", help="no curve edges and junctions in the surface"
    )
    group.add_argument("--single-precision", action="store_true", help="points as float")
    group.add_argument(
        "--label-cell-sizes",
        nargs="+",
        type=_label_size,
        metavar="ID=NUMBER",
        help="of the volume: cell sizes of single labels",
    )
    group.add_argument(
        "--keep-slivers", action="store_true", help="of the volume: leave tetrahedra Delaunay"
    )
    group.add_argument(
        "--keep-background", action="store_true", help="of the volume: with the background's"
    )
    talk = parser.add_argument_group("messages")
    talk.add_argument("-q", "--quiet", action="store_true", help="no progress, no report")
    talk.add_argument("--progress", action="store_true", help="progress also without a terminal")
    talk.add_argument("--version", action="version", version=f"mlim {__version__}")
    return parser


def _background(text: str) -> str | float:
    try:
        return float(text)
    except ValueError:
        return text


def _label_size(text: str) -> tuple[int, float]:
    label, _, size = text.partition("=")
    return int(label), float(size)


def _run(options: argparse.Namespace) -> None:
    progress = False if options.quiet else True if options.progress else None
    image = read(options.input)
    chosen = {name: getattr(options, name) for name in _OPTIONS}
    common = {"arrays": options.arrays, "background": options.background, "progress": progress}
    covered = None
    if options.curves or options.balls:
        # The stages one by one, so that none runs twice; the mesh is the same.
        labels = ("tie_breaking", "unseen_labels", "junction_merge_tolerance")
        found = meshing.curves(image, **common, **{name: chosen[name] for name in labels})
        size = options.facet_size
        covered = meshing.balls(
            found,
            edge_size=options.edge_size or size,
            facet_distance=options.facet_distance or size / 8,
            ball_radius_scale=options.ball_radius_scale,
            progress=progress,
        )
    made = meshing.mesh(
        image,
        **common,
        **chosen,
        cap_boundary=not options.no_caps,
        output_curves=not options.no_curves,
        single_precision=options.single_precision,
        volume=options.volume is not None,
        label_cell_sizes=dict(options.label_cell_sizes or ()),
        remove_slivers=not options.keep_slivers,
        keep_background=options.keep_background,
        balls=covered,
    )
    surface, volume = made if options.volume else (made, None)
    write(surface, options.output)
    if volume is not None:
        write_volume(volume, options.volume)
    if options.curves:
        write(found, options.curves)
    if options.balls:
        write(covered, options.balls)
    if not options.quiet:
        print(report(surface))
        if volume is not None:
            print(report(volume))


@contextlib.contextmanager
def _warnings_as_lines():
    """The filters' warnings as one line each."""

    def show(message, category, *_) -> None:
        print(f"mlim: warning: {message}", file=sys.stderr)

    with warnings.catch_warnings():
        warnings.simplefilter("always", MeshWarning)
        warnings.showwarning = show
        yield
