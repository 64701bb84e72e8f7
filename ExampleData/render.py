#!/usr/bin/env python3
"""Renders an interface surface to a picture: the whole, a cut-away, or both side by side.

    python3 ExampleData/render.py SURFACE.vtp PICTURE.png [--view both|whole|cutaway]
        [--remove ID ...] [--width PIXELS] [--azimuth DEGREES] [--elevation DEGREES] [--no-edges]

Interfaces with the background have their region's colour, inner interfaces a blend of their two
regions' colours; curves are tubes, junctions small balls. The cut-away leaves out the regions that
reach nearest to the viewer (or those named), and keeps their curves.
"""

import argparse
import sys

import numpy as np
import vtkmodules.vtkRenderingFreeType  # noqa: F401
import vtkmodules.vtkRenderingOpenGL2  # noqa: F401
from vtkmodules.util.numpy_support import vtk_to_numpy
from vtkmodules.vtkCommonDataModel import vtkCellArray, vtkPolyData
from vtkmodules.vtkFiltersCore import (
    vtkCleanPolyData,
    vtkGlyph3D,
    vtkPolyDataNormals,
    vtkStripper,
    vtkTubeFilter,
)
from vtkmodules.vtkFiltersSources import vtkSphereSource
from vtkmodules.vtkIOImage import vtkPNGWriter
from vtkmodules.vtkIOXML import vtkXMLPolyDataReader
from vtkmodules.vtkImagingCore import vtkImageShrink3D
from vtkmodules.vtkRenderingCore import (
    vtkActor,
    vtkLight,
    vtkPolyDataMapper,
    vtkRenderer,
    vtkRenderWindow,
    vtkWindowToImageFilter,
)

# Muted colours that stay apart from each other, also in pairs and for most colour-blind eyes.
PALETTE = np.array(
    [
        (78, 121, 167), (242, 142, 43), (89, 161, 79), (225, 87, 89), (176, 122, 161),
        (237, 201, 72), (118, 183, 178), (255, 157, 167), (156, 117, 95), (134, 188, 222),
        (140, 209, 125), (214, 170, 200),
    ],
    float,
) / 255
EDGE_COLOUR = (0.20, 0.22, 0.26)
CURVE_COLOUR = (0.10, 0.11, 0.14)
FREE_CURVE_COLOUR = (0.55, 0.57, 0.62)
# Each pixel of the picture is the mean of this many in each direction.
OVERSAMPLING = 2
# Share of the regions that the cut-away leaves out.
REMOVED_SHARE = 0.3
# How far forward a region reaches: this share of its triangles' corners lies behind.
FRONT_QUANTILE = 0.9
# Vertical angle of the view in degrees, and how much of it the surface fills.
VIEW_ANGLE = 18
FILLED_SHARE = 0.94
# Radius of a curve's tube, against the whole's diagonal; of a junction's ball, against the tube's.
TUBE_TO_DIAGONAL = 0.0025
BALL_TO_TUBE = 2.3


class Surface:
    """A surface's points and cells in numpy."""

    def __init__(self, polydata):
        self.polydata = polydata
        self.points = vtk_to_numpy(polydata.GetPoints().GetData()).astype(float)
        self.triangles = connectivity(polydata.GetPolys()).reshape(-1, 3)
        first = polydata.GetNumberOfVerts() + polydata.GetNumberOfLines()
        labels = vtk_to_numpy(polydata.GetCellData().GetArray("BoundaryLabels"))
        self.labels = labels[first:]
        self.curve_edges = connectivity(polydata.GetLines())
        self.junctions = connectivity(polydata.GetVerts())
        ids = np.unique(self.labels)
        self.regions = ids[ids != 0].tolist()

    def colour(self, label):
        return PALETTE[self.regions.index(label) % len(PALETTE)]

    def pair_colour(self, first, second):
        if second == 0:
            return self.colour(first)
        blend = 0.5 * (self.colour(first) + self.colour(second))
        return 0.25 + 0.75 * blend


def connectivity(cells):
    if cells.GetNumberOfCells() == 0:
        return np.zeros(0, np.int64)
    return vtk_to_numpy(cells.GetConnectivityArray()).astype(np.int64)


def frontmost_regions(surface, toward_viewer):
    """The regions that reach farthest towards the viewer, a few of all."""
    reach = []
    for label in surface.regions:
        used = surface.triangles[(surface.labels == label).any(axis=1)]
        depths = surface.points[used.ravel()] @ toward_viewer
        reach.append((-float(np.quantile(depths, FRONT_QUANTILE)), label))
    count = int(np.ceil(REMOVED_SHARE * len(reach))) if len(reach) > 1 else 0
    return [label for _, label in sorted(reach)[:count]]


def subset(surface, rows, is_lines=False):
    """A polydata of some of the triangles, or of edges."""
    cells = vtkCellArray()
    for row in rows.tolist():
        cells.InsertNextCell(len(row), row)
    result = vtkPolyData()
    result.SetPoints(surface.polydata.GetPoints())
    if is_lines:
        result.SetLines(cells)
    else:
        result.SetPolys(cells)
    clean = vtkCleanPolyData()
    clean.SetInputData(result)
    clean.PointMergingOff()
    clean.Update()
    return clean.GetOutput()


def make_actor(polydata, colour):
    mapper = vtkPolyDataMapper()
    mapper.SetInputData(polydata)
    mapper.ScalarVisibilityOff()
    actor = vtkActor()
    actor.SetMapper(mapper)
    look = actor.GetProperty()
    look.SetColor(*colour)
    look.SetInterpolationToPhong()
    look.SetAmbient(0.26)
    look.SetDiffuse(0.86)
    look.SetSpecular(0.12)
    look.SetSpecularPower(24)
    return actor


def interface_actors(surface, removed, has_edges):
    """One actor for each pair of labels, so that normals are smooth inside a pair only."""
    left_out = list(removed) + [0]
    shown = ~np.isin(surface.labels, left_out).all(axis=1)
    for first, second in np.unique(surface.labels[shown], axis=0).tolist():
        chosen = shown & (surface.labels == (first, second)).all(axis=1)
        normals = vtkPolyDataNormals()
        normals.SetInputData(subset(surface, surface.triangles[chosen]))
        normals.SetFeatureAngle(40)
        normals.ConsistencyOff()
        normals.Update()
        actor = make_actor(normals.GetOutput(), surface.pair_colour(first, second))
        actor.GetProperty().SetEdgeVisibility(has_edges)
        actor.GetProperty().SetEdgeColor(*EDGE_COLOUR)
        actor.GetProperty().SetLineWidth(0.5 * OVERSAMPLING)
        yield actor


def tube_radius(surface):
    return TUBE_TO_DIAGONAL * np.linalg.norm(np.ptp(surface.points, axis=0))


def curve_edge_rows(surface):
    """Pairs of neighbours on the lines."""
    lines = surface.polydata.GetLines()
    if lines.GetNumberOfCells() == 0:
        return np.zeros((0, 2), np.int64)
    pairs = np.stack([surface.curve_edges[:-1], surface.curve_edges[1:]], axis=1)
    is_within = np.ones(len(pairs), bool)
    is_within[vtk_to_numpy(lines.GetOffsetsArray())[1:-1] - 1] = False
    return pairs[is_within]


def curve_actors(surface, removed):
    edges = curve_edge_rows(surface)
    if len(edges) == 0:
        return
    left_out = list(removed) + [0]
    shown = surface.triangles[~np.isin(surface.labels, left_out).all(axis=1)]
    is_used = np.zeros(len(surface.points), bool)
    is_used[shown.ravel()] = True
    on_shown = is_used[edges].all(axis=1)
    radius = tube_radius(surface)
    for rows, colour, scale in (
        (edges[on_shown], CURVE_COLOUR, 1.0),
        (edges[~on_shown], FREE_CURVE_COLOUR, 0.7),
    ):
        if len(rows) == 0:
            continue
        stripper = vtkStripper()
        stripper.SetInputData(subset(surface, rows, is_lines=True))
        stripper.SetMaximumLength(100000)
        tube = vtkTubeFilter()
        tube.SetInputConnection(stripper.GetOutputPort())
        tube.SetRadius(scale * radius)
        tube.SetNumberOfSides(16)
        tube.CappingOn()
        tube.Update()
        yield make_actor(tube.GetOutput(), colour)


def junction_actors(surface):
    if len(surface.junctions) == 0:
        return
    balls = vtkSphereSource()
    balls.SetThetaResolution(24)
    balls.SetPhiResolution(24)
    balls.SetRadius(BALL_TO_TUBE * tube_radius(surface))
    cells = vtkCellArray()
    for junction in surface.junctions.tolist():
        cells.InsertNextCell(1, [junction])
    places = vtkPolyData()
    places.SetPoints(surface.polydata.GetPoints())
    places.SetVerts(cells)
    clean = vtkCleanPolyData()
    clean.SetInputData(places)
    clean.PointMergingOff()
    glyphs = vtkGlyph3D()
    glyphs.SetInputConnection(clean.GetOutputPort())
    glyphs.SetSourceConnection(balls.GetOutputPort())
    glyphs.ScalingOff()
    glyphs.Update()
    yield make_actor(glyphs.GetOutput(), CURVE_COLOUR)


def view_direction(azimuth, elevation):
    """Unit vector from the scene to the viewer; z is up."""
    a, e = np.radians(azimuth), np.radians(elevation)
    return np.array([np.cos(e) * np.cos(a), np.cos(e) * np.sin(a), np.sin(e)])


def make_renderer(surface, removed, toward_viewer, viewport, has_edges):
    renderer = vtkRenderer()
    renderer.SetViewport(*viewport)
    renderer.SetBackground(1, 1, 1)
    for actors in (
        interface_actors(surface, removed, has_edges),
        curve_actors(surface, removed),
        junction_actors(surface),
    ):
        for actor in actors:
            renderer.AddActor(actor)
    add_lights(renderer)
    place_camera(renderer, surface.points, toward_viewer)
    return renderer


def place_camera(renderer, points, toward_viewer):
    """All points fill the view, seen from `toward_viewer`; the view is at least as wide as high."""
    right = np.cross((0.0, 0.0, 1.0), toward_viewer)
    right /= np.linalg.norm(right)
    axes = np.stack([right, np.cross(toward_viewer, right), toward_viewer], axis=1)
    seen = points @ axes
    middle = 0.5 * (seen.min(axis=0) + seen.max(axis=0))
    seen -= middle
    slope = FILLED_SHARE * np.tan(np.radians(0.5 * VIEW_ANGLE))
    distance = (np.abs(seen[:, :2]).max(axis=1) / slope + seen[:, 2]).max()
    focus = axes @ middle
    camera = renderer.GetActiveCamera()
    camera.SetFocalPoint(*focus)
    camera.SetPosition(*(focus + distance * toward_viewer))
    camera.SetViewUp(0, 0, 1)
    camera.SetViewAngle(VIEW_ANGLE)
    renderer.ResetCameraClippingRange()


def add_lights(renderer):
    """A key light from above left and a weak fill light from the right, both with the camera."""
    renderer.AutomaticLightCreationOff()
    for position, intensity in (((-0.5, 0.8, 1.0), 0.86), ((1.0, -0.1, 1.0), 0.48)):
        light = vtkLight()
        light.SetLightTypeToCameraLight()
        light.SetPosition(*position)
        light.SetFocalPoint(0, 0, 0)
        light.SetIntensity(intensity)
        renderer.AddLight(light)


def write_picture(renderers, size, path):
    window = vtkRenderWindow()
    window.SetOffScreenRendering(1)
    window.SetMultiSamples(0)
    window.SetSize(OVERSAMPLING * size[0], OVERSAMPLING * size[1])
    for renderer in renderers:
        window.AddRenderer(renderer)
    window.Render()
    grab = vtkWindowToImageFilter()
    grab.SetInput(window)
    grab.ReadFrontBufferOff()
    mean = vtkImageShrink3D()
    mean.SetInputConnection(grab.GetOutputPort())
    mean.SetShrinkFactors(OVERSAMPLING, OVERSAMPLING, 1)
    mean.AveragingOn()
    writer = vtkPNGWriter()
    writer.SetInputConnection(mean.GetOutputPort())
    writer.SetFileName(path)
    writer.SetCompressionLevel(9)
    writer.Write()


def read_surface(path):
    reader = vtkXMLPolyDataReader()
    reader.SetFileName(path)
    reader.Update()
    if reader.GetOutput().GetNumberOfPolys() == 0:
        sys.exit(f"{path} holds no triangle")
    return Surface(reader.GetOutput())


def main():
    parser = argparse.ArgumentParser(description=__doc__.splitlines()[0])
    parser.add_argument("surface")
    parser.add_argument("picture")
    parser.add_argument("--view", choices=("both", "whole", "cutaway"), default="both")
    parser.add_argument("--remove", type=int, nargs="*", help="ids of the regions to leave out")
    parser.add_argument("--width", type=int, default=1600, help="pixels")
    parser.add_argument("--azimuth", type=float, default=-52, help="degrees from x towards y")
    parser.add_argument("--elevation", type=float, default=24, help="degrees above the xy plane")
    parser.add_argument(
        "--edges", action=argparse.BooleanOptionalAction, default=True, help="the triangles' edges"
    )
    options = parser.parse_args()

    surface = read_surface(options.surface)
    toward_viewer = view_direction(options.azimuth, options.elevation)
    removed = options.remove
    if removed is None:
        removed = frontmost_regions(surface, toward_viewer)
    scenes = {"whole": [[]], "cutaway": [removed], "both": [[], removed]}[options.view]
    renderers = [
        make_renderer(
            surface,
            scene,
            toward_viewer,
            (k / len(scenes), 0, (k + 1) / len(scenes), 1),
            options.edges,
        )
        for k, scene in enumerate(scenes)
    ]
    height = options.width // 2 if options.view == "both" else 3 * options.width // 4
    write_picture(renderers, (options.width, height), options.picture)


if __name__ == "__main__":
    main()
