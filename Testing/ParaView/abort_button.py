"""Run in ParaView's user interface by TestAbortButton.py: starts a run that does not end by itself,
then one that does, and writes down what happens to the mesher."""

import json
import os
import time

from paraview import simple

import plugin

# Millions of triangles, and a thousand.
TOO_FINE, COARSE = 0.002, 0.1

folder = os.environ["MLIM_FOLDER"]
log = open(os.path.join(folder, "log"), "w", buffering=1)


def write(what, algorithm):
    points = algorithm.GetOutputDataObject(0).GetNumberOfPoints()
    log.write(json.dumps({"what": what, "time": time.time(), "points": points}) + "\n")


def watch(algorithm):
    """Writes the start of the refinement, the abort and the end of each run down."""
    stage = []

    def on_progress(caller, _event):
        if caller.GetProgressText() == "Refining the interface" and not stage:
            stage.append(True)
            write("refining", caller)

    def on_end(caller, _event):
        stage.clear()
        write("end", caller)

    algorithm.AddObserver("ProgressEvent", on_progress)
    algorithm.AddObserver("EndEvent", on_end)


mesher = simple.MultiLabelInterfaceMesher(Input=plugin.read())
mesher.FacetSize = TOO_FINE
watch(mesher.GetClientSideObject())
simple.SetActiveSource(mesher)
# Aborted by the first clicks. A script that goes on gets its next mesh.
simple.Show(mesher)
mesher.FacetSize = COARSE
mesher.UpdatePipeline()
write("coarse", mesher.GetClientSideObject())
mesher.FacetSize = TOO_FINE
mesher.UpdatePipeline()  # aborted as well
write("waiting", mesher.GetClientSideObject())
