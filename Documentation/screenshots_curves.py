"""Run in ParaView by screenshots.sh: the spheres' curves, and their balls as glyphs."""

import os

from paraview import simple

image = simple.XMLImageDataReader(
    registrationName="spheres.vti",
    FileName=[os.path.join(os.environ["MLIM_EXAMPLE_DATA"], "spheres.vti")],
)
curves = simple.MultiLabelCurveExtractor(registrationName="Curves", Input=image)
balls = simple.MultiLabelCurveProtector(registrationName="Balls", Input=curves)
spheres = simple.Glyph(
    registrationName="Balls as spheres", Input=balls, GlyphType="Sphere", GlyphMode="All Points"
)
spheres.ScaleArray = ["POINTS", "Radius"]
spheres.ScaleFactor = 2.0  # the sphere's own radius is 0.5
spheres.GlyphType.ThetaResolution = spheres.GlyphType.PhiResolution = 24
view = simple.GetActiveViewOrCreate("RenderView")
shown = simple.Show(curves, view)
shown.LineWidth = 3
simple.Show(spheres, view).SetScalarBarVisibility(view, True)
view.ApplyIsometricView()
simple.ResetCamera(view)
simple.SetActiveSource(spheres)
simple.Render(view)
with open(os.environ["MLIM_READY"], "w", encoding="ascii"):
    pass
