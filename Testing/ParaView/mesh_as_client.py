"""Run by TestProcesses in pvpython, with the port of a pvserver or without: the mesh as a client
sees it."""

import json
import sys

import plugin
from paraview import simple

is_remote = len(sys.argv) > 1
if is_remote:
    simple.Connect("127.0.0.1", int(sys.argv[1]))
    plugin.load(remote=True)
plugin.load()
mesher = simple.MultiLabelInterfaceMesher(Input=plugin.read())
view = simple.CreateRenderView()
display = simple.Show(mesher, view)
simple.Render(view)
surface = plugin.fetch(mesher)
print(
    json.dumps(
        {
            "facet size": mesher.FacetSize,
            "triangles": surface.GetNumberOfPolys(),
            "colour": list(display.ColorArrayName),
            "digest": plugin.digest(surface),
        }
    ),
    flush=True,
)
if is_remote:
    simple.Disconnect()
