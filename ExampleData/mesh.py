#!/usr/bin/env python3
"""Meshes the interfaces of an image and writes surface, curves and balls.

    python3 ExampleData/mesh.py IMAGE.vti FOLDER [--option value ...]

Options are those of mlim.mesh, with dashes: --facet-size 1.5 --background complement.
"""

import ast
import sys
from pathlib import Path

from vtkmodules.vtkIOXML import vtkXMLPolyDataWriter

import mlim


def parse_options(words):
    """{name: value} of --name value pairs; values are Python literals, or else texts."""
    options = {}
    for word, text in zip(words[0::2], words[1::2]):
        try:
            value = ast.literal_eval(text)
        except (SyntaxError, ValueError):
            value = text
        options[word.removeprefix("--").replace("-", "_")] = value
    return options


def write(polydata, path):
    writer = vtkXMLPolyDataWriter()
    writer.SetFileName(str(path))
    writer.SetInputData(polydata)
    if not writer.Write():
        raise OSError(f"cannot write {path}")


def main():
    if len(sys.argv) < 3 or len(sys.argv) % 2 == 0:
        sys.exit(__doc__)
    image, folder = mlim.read(sys.argv[1]), Path(sys.argv[2])
    surface = mlim.mesh(image, **parse_options(sys.argv[3:]))
    print(mlim.report(surface))
    write(surface, folder / "surface.vtp")

    curves = mlim.vtkMultiLabelCurveExtractor()
    curves.SetInputData(image)
    balls = mlim.vtkMultiLabelCurveProtector()
    balls.SetInputConnection(curves.GetOutputPort())
    balls.Update()
    write(curves.GetOutput(), folder / "curves.vtp")
    write(balls.GetOutput(), folder / "balls.vtp")


if __name__ == "__main__":
    main()
