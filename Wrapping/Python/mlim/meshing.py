"""An interface mesh in one call."""

from __future__ import annotations

import os
import sys
from typing import TYPE_CHECKING, Callable, Iterable

from .readers import _collect_errors, read
from .vtkMultiLabelInterfaceMesher import vtkMultiLabelInterfaceMesher

if TYPE_CHECKING:
    from vtkmodules.vtkCommonDataModel import vtkImageData, vtkPolyData

Progress = Callable[[float, str], object]


class MeshError(RuntimeError):
    """The image or an option cannot be used, or meshing failed; the text says why."""


def mesh(
    image: vtkImageData | str | os.PathLike[str],
    arrays: Iterable[str] | None = None,
    background: str | float | None = None,
    *,
    facet_size: float = 0.0,
    facet_radius_edge_ratio: float = 1.0,
    facet_distance: float = 0.0,
    volume_tolerance: float = 0.02,
    edge_size: float = 0.0,
    ball_radius_scale: float = 1.0,
    crossing_tolerance: float = 0.0,
    junction_merge_tolerance: float = 0.0,
    oracle_mode: str = "exact",
    tie_breaking: str = "smooth",
    unseen_labels: str = "keep",
    cap_boundary: bool = True,
    output_curves: bool = True,
    minimum_component_voxels: int | None = None,
    vertex_limit: int | None = None,
    single_precision: bool = False,
    balls: vtkPolyData | None = None,
    progress: bool | Progress | None = None,
) -> vtkPolyData:
    """The interface surface of a multi-label image, as vtkMultiLabelInterfaceMesher makes it.

    image: a vtkImageData, or the path of a file that mlim.read knows.
    arrays: names of the arrays to use, one a label; None: all with one component. One array of an
        integer type alone is a label map, as long as `background` is None; its ids are kept, and 0
        is the background. vtkMultiLabelIndicators makes maps into arrays with other settings.
    background: None: the array called "background", if there is one; another text: the array of
        that name; a number: one more label with this indicator everywhere (0 for signed
        distances); "complement": one more label with what the others leave of the largest sum
        (probabilities).
    Lengths are in world units; 0: from the image's spacing. The class documents each option.
    oracle_mode: "exact" or "bisection". tie_breaking: "smooth" or "lowest_index".
    unseen_labels: "keep" or "drop".
    output_curves: False for vtkSurfaceNetsAtlas, which cannot use a surface with curves.
    balls: output of vtkMultiLabelCurveProtector for this image; None: made here.
    progress: True or False: a line on sys.stderr or none; None: a line if that is a terminal; a
        function: called with the fraction done and the stage's name, and stops the run by
        returning False.

    Raises MeshError with the filter's sentence, also if `progress` stopped the run.
    """
    if isinstance(image, (str, os.PathLike)):
        image = read(image)
    mesher = vtkMultiLabelInterfaceMesher()
    mesher.SetInputData(image)
    if balls is not None:
        mesher.SetBallsData(balls)
    for name in [arrays] if isinstance(arrays, str) else arrays or ():
        mesher.GetPointArraySelection().EnableArray(name)
    _set_background(mesher, background)
    mesher.SetFacetSize(facet_size)
    mesher.SetFacetRadiusEdgeRatio(facet_radius_edge_ratio)
    mesher.SetFacetDistance(facet_distance)
    mesher.SetVolumeTolerance(volume_tolerance)
    mesher.SetEdgeSize(edge_size)
    mesher.SetBallRadiusScale(ball_radius_scale)
    mesher.SetCrossingTolerance(crossing_tolerance)
    mesher.SetJunctionMergeTolerance(junction_merge_tolerance)
    mesher.SetOracleMode(_index("oracle_mode", oracle_mode, ("exact", "bisection")))
    mesher.SetTieBreaking(_index("tie_breaking", tie_breaking, ("smooth", "lowest_index")))
    mesher.SetUnseenLabels(_index("unseen_labels", unseen_labels, ("keep", "drop")))
    mesher.SetCapBoundary(cap_boundary)
    mesher.SetOutputCurves(output_curves)
    if minimum_component_voxels is not None:
        mesher.SetMinimumComponentVoxels(minimum_component_voxels)
    if vertex_limit is not None:
        mesher.SetVertexLimit(vertex_limit)
    if single_precision:
        mesher.SetOutputPointsPrecision(mesher.SINGLE_PRECISION)
    return _run(mesher, progress)


def _index(name: str, value: str, values: tuple[str, ...]) -> int:
    if value not in values:
        raise ValueError(f"{name} is {value!r}; it has to be one of {', '.join(values)}")
    return values.index(value)


def _set_background(mesher, background: str | float | None) -> None:
    if background is None:
        return
    if not isinstance(background, str):
        mesher.SetBackgroundModeToConstant()
        mesher.SetBackgroundValue(float(background))
    elif background == "complement":
        mesher.SetBackgroundModeToComplement()
    else:
        mesher.SetBackgroundArrayName(background)


def _run(mesher, progress: bool | Progress | None) -> vtkPolyData:
    errors: list[str] = []
    _collect_errors(mesher, errors)
    if progress is None:
        progress = sys.stderr is not None and sys.stderr.isatty()
    show = _print_progress if progress is True else progress or None
    raised: list[BaseException] = []

    def report_progress(caller, _event) -> None:
        try:
            if show(caller.GetProgress(), caller.GetProgressText() or "") is False:
                caller.SetAbortExecute(True)
        except BaseException as error:  # VTK would print it and go on
            raised.append(error)
            caller.SetAbortExecute(True)

    if show is not None:
        mesher.AddObserver("ProgressEvent", report_progress)
    mesher.Update()
    if show is _print_progress:
        print(file=sys.stderr)
    if raised:
        raise raised[0]
    if errors:
        raise MeshError(errors[0])
    if mesher.GetAbortExecute():
        raise MeshError("Stopped by the progress function.")
    surface = mesher.GetOutput()
    return surface


def _print_progress(fraction: float, stage: str) -> None:
    print(f"\r{stage:<32} {fraction:4.0%}", end="", file=sys.stderr, flush=True)
