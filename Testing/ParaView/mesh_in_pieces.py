"""Run by TestProcesses in each process of pvbatch: what this process holds of each stage."""

import json

import plugin
from paraview import simple
from paraview.vtk import vtkMultiProcessController

plugin.load()
image = plugin.read()
curves = simple.MultiLabelCurveExtractor(Input=image)
balls = simple.MultiLabelCurveProtector(Input=curves)
surface = simple.MultiLabelInterfaceMesher(Input=image)
label_map = simple.Calculator(
    Input=image, Function="(sphere1 > 0) + 2 * (sphere2 > 0)", ResultArrayName="labels"
)
indicators = simple.MultiLabelIndicators(Input=label_map, LabelArray=["POINTS", "labels"])
regions = simple.MultiLabelInterfaceMesher(Input=indicators)
regions.PointArrays = ["background", "label_1", "label_2"]
report = {"rank": vtkMultiProcessController.GetGlobalController().GetLocalProcessId()}
stages = {"curves": curves, "balls": balls, "surface": surface, "regions": regions}
for name, stage in stages.items():
    stage.UpdatePipeline()
    data = stage.GetClientSideObject().GetOutputDataObject(0)
    owners = (data.GetPointData(), data.GetCellData())
    report[name] = {
        "points": data.GetNumberOfPoints(),
        "cells": data.GetNumberOfCells(),
        "arrays": sorted(o.GetArrayName(i) for o in owners for i in range(o.GetNumberOfArrays())),
        "digest": plugin.digest(data) if data.GetNumberOfPoints() else "",
    }
# One write a process, so that lines do not mix.
print(json.dumps(report) + "\n", end="", flush=True)
