"""The filters in a script of ParaView: mesh, curves and balls of an image, a picture and a state file.

    pvpython Examples/ParaView/mesh_labels.py PLUGIN.so IMAGE.vti FOLDER [FACET_SIZE]

PLUGIN.so is MultiLabelInterfaceMesherPlugin.so. Also for pvbatch, and mpirun -np N pvbatch. ParaView
draws through X even without a window: on a machine without a display, xvfb-run -a pvpython ...
"""

import os
import sys

from paraview import servermanager, simple


def colour_by_name(mesh):
    """One colour a region, with the regions' names as legend."""
    figures = servermanager.Fetch(mesh).GetFieldData()
    ids, names = figures.GetArray("LabelIds"), figures.GetAbstractArray("LabelNames")
    table = simple.GetColorTransferFunction("Label")
    table.InterpretValuesAsCategories = 1
    legend = []
    for entry in range(ids.GetNumberOfValues()):
        region = int(ids.GetComponent(entry, 0))
        # Triangles have a region; 0 is what curves and junctions have.
        legend += [str(region), names.GetValue(entry) if region != 0 else "curves"]
    table.Annotations = legend
    table.ApplyPreset("Brewer Qualitative Set3", True)
    return table


def main():
    if len(sys.argv) not in (4, 5):
        sys.exit(__doc__)
    plugin, image_path, folder = sys.argv[1:4]
    simple.LoadPlugin(plugin, remote=False, ns=vars(simple))

    image = simple.XMLImageDataReader(FileName=[image_path])
    curves = simple.MultiLabelCurveExtractor(Input=image)
    balls = simple.MultiLabelCurveProtector(Input=curves)
    # Without balls the mesher makes them itself, with the same result.
    mesh = simple.MultiLabelInterfaceMesher(Input=image, Balls=balls)
    if len(sys.argv) == 5:
        mesh.FacetSize = float(sys.argv[4])
    # Inline data: with a newer XML parser, ParaView 5.11 cannot read the appended data of its default.
    simple.SaveData(os.path.join(folder, "surface.vtp"), proxy=mesh, DataMode="Binary")

    view = simple.CreateRenderView(ViewSize=[1000, 700])
    display = simple.Show(mesh, view)
    colour_by_name(mesh)
    display.SetScalarBarVisibility(view, True)
    spheres = simple.Glyph(Input=balls, GlyphType="Sphere", GlyphMode="All Points")
    spheres.ScaleArray = ["POINTS", "Radius"]
    spheres.ScaleFactor = 2.0  # the sphere's own radius is 0.5
    spheres.GlyphType.ThetaResolution = spheres.GlyphType.PhiResolution = 24
    simple.Show(spheres, view)
    view.ApplyIsometricView()
    simple.ResetCamera(view)
    simple.SaveScreenshot(os.path.join(folder, "mesh.png"), view)
    simple.SaveState(os.path.join(folder, "mesh.pvsm"))


if __name__ == "__main__":
    main()
