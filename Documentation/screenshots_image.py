"""Run in ParaView by screenshots.sh: the brain atlas is loaded and active, nothing more."""

import os

from paraview import simple

image = simple.XMLImageDataReader(
    registrationName="brain_atlas_mni_prob.vti",
    FileName=[os.path.join(os.environ["MLIM_DATA"], "brain_atlas_mni_prob.vti")],
)
image.UpdatePipeline()
view = simple.GetActiveViewOrCreate("RenderView")
simple.Show(image, view)
view.ApplyIsometricView()
simple.ResetCamera(view)
# From the front right, above.
camera = view.GetActiveCamera()
camera.SetPosition(camera.GetFocalPoint()[0] + 400, camera.GetFocalPoint()[1] + 330, 260)
camera.SetViewUp(0, 0, 1)
simple.ResetCamera(view)
camera.Dolly(1.6)
simple.SetActiveSource(image)
simple.Render(view)
with open(os.environ["MLIM_READY"], "w", encoding="ascii"):
    pass
