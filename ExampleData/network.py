#!/usr/bin/env python3
"""Renders a curve network and its protecting balls: one colour a curve, junctions as points.

    python3 ExampleData/network.py CURVES.vtp BALLS.vtp PICTURE.png [--view both|curves|balls]
        [--width PIXELS] [--azimuth DEGREES] [--elevation DEGREES]

CURVES and BALLS are outputs of vtkMultiLabelCurveExtractor and vtkMultiLabelCurveProtector. A ball is
a sphere with its own radius, in the colour of its curve; the balls of junctions are dark.
"""

import argparse
import sys

import numpy as np
from vtkmodules.util.numpy_support import numpy_to_vtk, vtk_to_numpy
from vtkmodules.vtkCommonCore import vtkPoints
from vtkmodules.vtkCommonDataModel import vtkCellArray, vtkPolyData
from vtkmodules.vtkFiltersCore import vtkGlyph3D, vtkTubeFilter
from vtkmodules.vtkFiltersSources import vtkSphereSource
from vtkmodules.vtkIOXML import vtkXMLPolyDataReader
from vtkmodules.vtkRenderingCore import vtkRenderer

from render import (
    BALL_TO_TUBE,
    CURVE_COLOUR,
    PALETTE,
    TUBE_TO_DIAGONAL,
    add_lights,
    make_actor,
    place_camera,
    view_direction,
    write_picture,
)

# Against the tubes of a mesh, which has surfaces to show as well.
TUBE_SCALE = 1.6
# Inside the balls a curve is a thread.
INNER_TUBE_SCALE = 0.6
SPHERE_RESOLUTION = 24


class Network:
    """Points, curves as lists of point ids, and the points that are junctions."""

    def __init__(self, polydata):
        self.points = vtk_to_numpy(polydata.GetPoints().GetData()).astype(float)
        self.curves = rows(polydata.GetLines())
        self.junctions = [row[0] for row in rows(polydata.GetVerts())]
        self.colours = self.choose_colours()
        self.tube_radius = (
            TUBE_SCALE * TUBE_TO_DIAGONAL * np.linalg.norm(np.ptp(self.points, axis=0))
        )

    def choose_colours(self):
        """An entry of the palette for each curve; curves that meet differ as far as it goes."""
        at_end, chosen = {}, []
        counts = [0] * len(PALETTE)
        for curve in self.curves:
            taken = set().union(*(at_end.setdefault(end, set()) for end in (curve[0], curve[-1])))
            colour = min(
                range(len(PALETTE)), key=lambda entry: (entry in taken, counts[entry], entry)
            )
            counts[colour] += 1
            chosen.append(colour)
            for end in (curve[0], curve[-1]):
                at_end[end].add(colour)
        return chosen


def rows(cells):
    """Lists of point ids, one a cell."""
    offsets = vtk_to_numpy(cells.GetOffsetsArray())
    ids = vtk_to_numpy(cells.GetConnectivityArray())
    return [ids[begin:end].tolist() for begin, end in zip(offsets, offsets[1:])]


def polyline(points):
    cells = vtkCellArray()
    cells.InsertNextCell(len(points), list(range(len(points))))
    places = vtkPoints()
    places.SetData(numpy_to_vtk(np.ascontiguousarray(points), deep=True))
    result = vtkPolyData()
    result.SetPoints(places)
    result.SetLines(cells)
    return result


def curve_actors(network, scale=1.0):
    for curve, colour in zip(network.curves, network.colours):
        tube = vtkTubeFilter()
        tube.SetInputData(polyline(network.points[curve]))
        tube.SetRadius(scale * network.tube_radius)
        tube.SetNumberOfSides(16)
        tube.CappingOn()
        tube.Update()
        yield make_actor(tube.GetOutput(), PALETTE[colour])


def sphere_actor(centers, radii, colour):
    places = vtkPoints()
    places.SetData(numpy_to_vtk(np.ascontiguousarray(centers), deep=True))
    data = vtkPolyData()
    data.SetPoints(places)
    data.GetPointData().SetScalars(numpy_to_vtk(np.ascontiguousarray(radii), deep=True))
    sphere = vtkSphereSource()
    sphere.SetRadius(1.0)
    sphere.SetThetaResolution(SPHERE_RESOLUTION)
    sphere.SetPhiResolution(SPHERE_RESOLUTION)
    glyphs = vtkGlyph3D()
    glyphs.SetInputData(data)
    glyphs.SetSourceConnection(sphere.GetOutputPort())
    glyphs.SetScaleModeToScaleByScalar()
    glyphs.Update()
    return make_actor(glyphs.GetOutput(), colour)


def junction_actors(network):
    if network.junctions:
        radii = np.full(len(network.junctions), BALL_TO_TUBE * network.tube_radius)
        yield sphere_actor(network.points[network.junctions], radii, CURVE_COLOUR)


def ball_actors(network, balls):
    centers = vtk_to_numpy(balls.GetPoints().GetData()).astype(float)
    radii = vtk_to_numpy(balls.GetPointData().GetArray("Radius"))
    curves = vtk_to_numpy(balls.GetPointData().GetArray("CurveId"))
    colours = np.append(network.colours, -1)[curves]  # the last entry is for junctions
    for colour in np.unique(colours):
        chosen = colours == colour
        shown = CURVE_COLOUR if colour < 0 else PALETTE[colour]
        yield sphere_actor(centers[chosen], radii[chosen], shown)


def make_renderer(actors, points, toward_viewer, viewport):
    renderer = vtkRenderer()
    renderer.SetViewport(*viewport)
    renderer.SetBackground(1, 1, 1)
    for actor in actors:
        renderer.AddActor(actor)
    add_lights(renderer)
    place_camera(renderer, points, toward_viewer)
    return renderer


def read(path):
    reader = vtkXMLPolyDataReader()
    reader.SetFileName(path)
    reader.Update()
    if reader.GetOutput().GetNumberOfLines() == 0:
        print(f"{path} holds no curve: no picture")
        sys.exit(0)
    return reader.GetOutput()


def main():
    parser = argparse.ArgumentParser(description=__doc__.splitlines()[0])
    parser.add_argument("curves")
    parser.add_argument("balls")
    parser.add_argument("picture")
    parser.add_argument("--view", choices=("both", "curves", "balls"), default="both")
    parser.add_argument("--width", type=int, default=1600, help="pixels")
    parser.add_argument("--azimuth", type=float, default=-52, help="degrees from x towards y")
    parser.add_argument("--elevation", type=float, default=24, help="degrees above the xy plane")
    options = parser.parse_args()

    network, balls = Network(read(options.curves)), read(options.balls)
    scenes = {
        "curves": lambda: [*curve_actors(network), *junction_actors(network)],
        "balls": lambda: [
            *curve_actors(network, INNER_TUBE_SCALE),
            *ball_actors(network, balls),
        ],
    }
    views = ("curves", "balls") if options.view == "both" else (options.view,)
    toward_viewer = view_direction(options.azimuth, options.elevation)
    renderers = [
        make_renderer(
            scenes[view](), network.points, toward_viewer, (k / len(views), 0, (k + 1) / len(views), 1)
        )
        for k, view in enumerate(views)
    ]
    height = options.width // 2 if options.view == "both" else 3 * options.width // 4
    write_picture(renderers, (options.width, height), options.picture)


if __name__ == "__main__":
    main()
