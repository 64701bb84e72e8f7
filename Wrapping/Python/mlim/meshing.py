"""A mesh, its curves or its balls in one call."""

from __future__ import annotations

import os
from typing import TYPE_CHECKING, Iterable, Mapping


from .readers import read
from .running import Progress, update
from .vtkMultiLabelInterfaceMesher import (
    vtkMultiLabelCurveExtractor,
    vtkMultiLabelCurveProtector,
    vtkMultiLabelInterfaceMesher,
)

if TYPE_CHECKING:
    from vtkmodules.vtkCommonDataModel import vtkImageData, vtkPolyData, vtkUnstructuredGrid

    Image = vtkImageData | str | os.PathLike[str]


def mesh(
    image: Image,
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
    volume: bool = False,
    cell_size: float = 0.0,
    label_cell_sizes: Mapping[int, float] | None = None,
    cell_radius_edge_ratio: float = 2.0,
    remove_slivers: bool = True,
    keep_background: bool = False,
    balls: vtkPolyData | None = None,
    progress: bool | Progress | None = None,
) -> vtkPolyData | tuple[vtkPolyData, vtkUnstructuredGrid]:
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
    volume: True: the result is a pair, the surface and the regions filled with tetrahedra; the
        next five options are the volume's. label_cell_sizes: cell sizes of single labels, by id.
    balls: output of vtkMultiLabelCurveProtector for this image; None: made here.
    progress: True or False: a line on sys.stderr or none; None: a line if that is a terminal; a
        function: called with the fraction done and the stage's name, and stops the run by
        returning False.

    Raises MeshError with the filter's sentence, also if `progress` stopped the run, and
    KeyboardInterrupt within half a second of Ctrl-C. Warnings are of the category MeshWarning.
    """
    mesher = vtkMultiLabelInterfaceMesher()
    _set_input(mesher, image, arrays, background)
    if balls is not None:
        mesher.SetBallsData(balls)
    mesher.SetFacetSize(facet_size)
    mesher.SetFacetRadiusEdgeRatio(facet_radius_edge_ratio)
    mesher.SetFacetDistance(facet_distance)
    mesher.SetVolumeTolerance(volume_tolerance)
    mesher.SetEdgeSize(edge_size)
    mesher.SetBallRadiusScale(ball_radius_scale)
    mesher.SetCrossingTolerance(crossing_tolerance)
    mesher.SetJunctionMergeTolerance(junction_merge_tolerance)
    mesher.SetOracleMode(_index("oracle_mode", oracle_mode, ("exact", "bisection")))
    _set_labels(mesher, tie_breaking, unseen_labels)
    mesher.SetCapBoundary(cap_boundary)
    mesher.SetOutputCurves(output_curves)
    if minimum_component_voxels is not None:
        mesher.SetMinimumComponentVoxels(minimum_component_voxels)
    if vertex_limit is not None:
        mesher.SetVertexLimit(vertex_limit)
    if single_precision:
        mesher.SetOutputPointsPrecision(mesher.SINGLE_PRECISION)
    mesher.SetVolumeMesh(volume)
    mesher.SetCellSize(cell_size)
    for label, size in (label_cell_sizes or {}).items():
        if not size > 0.0:
            raise ValueError(f"the cell size of label {label} is {size!r}; it has to be above 0")
        mesher.SetLabelCellSize(label, size)
    mesher.SetCellRadiusEdgeRatio(cell_radius_edge_ratio)
    mesher.SetRemoveSlivers(remove_slivers)
    mesher.SetKeepBackground(keep_background)
    update(mesher, progress)
    surface = mesher.GetOutput()
    return (surface, mesher.GetVolumeOutput()) if volume else surface


def curves(
    image: Image,
    arrays: Iterable[str] | None = None,
    background: str | float | None = None,
    *,
    junction_merge_tolerance: float = 0.0,
    tie_breaking: str = "smooth",
    unseen_labels: str = "keep",
    progress: bool | Progress | None = None,
) -> vtkPolyData:
    """The curves where three or more labels meet, as vtkMultiLabelCurveExtractor finds them.

    The arguments mean what they mean for mlim.mesh, and so do the exceptions.
    """
    extractor = vtkMultiLabelCurveExtractor()
    _set_input(extractor, image, arrays, background)
    extractor.SetJunctionMergeTolerance(junction_merge_tolerance)
    _set_labels(extractor, tie_breaking, unseen_labels)
    update(extractor, progress)
    return extractor.GetOutput()


def balls(
    curves: vtkPolyData,
    *,
    edge_size: float = 0.0,
    facet_distance: float = 0.0,
    ball_radius_scale: float = 1.0,
    progress: bool | Progress | None = None,
) -> vtkPolyData:
    """Protecting balls on the output of mlim.curves, as vtkMultiLabelCurveProtector places them.

    Lengths are in world units; edge_size 0: twice the image's spacing; facet_distance 0: an eighth
    of edge_size. Exceptions as for mlim.mesh.
    """
    protector = vtkMultiLabelCurveProtector()
    protector.SetInputData(curves)
    protector.SetEdgeSize(edge_size)
    protector.SetFacetDistance(facet_distance)
    protector.SetBallRadiusScale(ball_radius_scale)
    update(protector, progress)
    return protector.GetOutput()


def _set_input(
    algorithm, image: Image, arrays: Iterable[str] | None, background: str | float | None
) -> None:
    if isinstance(image, (str, os.PathLike)):
        image = read(image)
    names = [arrays] if isinstance(arrays, str) else list(arrays or ())
    algorithm.SetInputData(image)
    for name in names:
        algorithm.GetPointArraySelection().EnableArray(name)
    _set_background(algorithm, background)


def _index(name: str, value: str, values: tuple[str, ...]) -> int:
    if value not in values:
        raise ValueError(f"{name} is {value!r}; it has to be one of {', '.join(values)}")
    return values.index(value)


def _set_labels(algorithm, tie_breaking: str, unseen_labels: str) -> None:
    algorithm.SetTieBreaking(_index("tie_breaking", tie_breaking, ("smooth", "lowest_index")))
    algorithm.SetUnseenLabels(_index("unseen_labels", unseen_labels, ("keep", "drop")))


def _set_background(algorithm, background: str | float | None) -> None:
    if background is None:
        return
    if not isinstance(background, str):
        algorithm.SetBackgroundModeToConstant()
        algorithm.SetBackgroundValue(float(background))
    elif background == "complement":
        algorithm.SetBackgroundModeToComplement()
    else:
        algorithm.SetBackgroundArrayName(background)
