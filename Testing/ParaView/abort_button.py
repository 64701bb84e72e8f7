"""Run in ParaView's user interface by TestAbortButton.py: makes what the test needs, and writes down
what happens to the mesher. MLIM_CASE names the function to run."""

import json
import os
import time

import numpy as np
from paraview import servermanager, simple

import plugin

# Millions of triangles, and a thousand.
TOO_FINE, COARSE = 0.002, 0.1
# Of a label map that takes the mesher many seconds with its default size.
SIZE, BALLS = 160, 40

log = open(os.path.join(os.environ["MLIM_FOLDER"], "log"), "w", buffering=1)


def write(what, algorithm=None):
    points = algorithm.GetOutputDataObject(0).GetNumberOfPoints() if algorithm else 0
    log.write(json.dumps({"what": what, "time": time.time(), "points": points}) + "\n")


def watch(algorithm):
    """Writes the start, that of the refinement, and the end of each run down."""
    stage = []

    def on_progress(caller, _event):
        if caller.GetProgressText() == "Refining the interface" and not stage:
            stage.append(True)
            write("refining", caller)

    def on_start(caller, _event):
        stage.clear()
        write("start", caller)

    def on_end(caller, _event):
        write("end", caller)

    algorithm.AddObserver("StartEvent", on_start)
    algorithm.AddObserver("ProgressEvent", on_progress)
    algorithm.AddObserver("EndEvent", on_end)


def script():
    """A script whose runs are aborted, and that goes on."""
    mesher = simple.MultiLabelInterfaceMesher(Input=plugin.read())
    algorithm = mesher.GetClientSideObject()
    mesher.FacetSize = TOO_FINE
    watch(algorithm)
    simple.Show(mesher)  # aborted
    mesher.FacetSize = COARSE
    mesher.UpdatePipeline()
    write("coarse", algorithm)
    mesher.FacetSize = TOO_FINE
    mesher.UpdatePipeline()  # aborted
    write("done", algorithm)


def apply():
    """An image from which the user makes a mesher by the menu."""
    grid = np.indices((SIZE,) * 3, np.float32)
    labels = np.zeros((SIZE,) * 3, np.uint8)
    random = np.random.default_rng(1)
    for label in range(1, BALLS + 1):
        center, radius = random.uniform(0.1 * SIZE, 0.9 * SIZE, 3), random.uniform(0.1, 0.2) * SIZE
        squares = sum((axis - c) ** 2 for axis, c in zip(grid, center))
        labels[squares < radius**2] = label
    source = plugin.source_of(plugin.make_image({"labels": labels.ravel()}, SIZE))
    simple.Show(source)
    simple.SetActiveSource(source)
    seen = set()

    def on_register(_caller, _event):
        for (name, key), proxy in simple.GetSources().items():
            if name.startswith("MultiLabelInterfaceMesher") and key not in seen:
                seen.add(key)
                watch(proxy.GetClientSideObject())
                write("made")

    manager = servermanager.vtkSMProxyManager.GetProxyManager()
    manager.AddObserver("RegisterEvent", on_register)
    write("ready")


{"script": script, "apply": apply}[os.environ["MLIM_CASE"]]()
