"""Interface meshes of multi-label images.

    import mlim
    surface = mlim.mesh("atlas.vti", facet_size=2.0)
    print(mlim.report(surface))
    surface, volume = mlim.mesh("atlas.vti", facet_size=2.0, volume=True)
    mlim.write_volume(volume, "atlas.msh")

The filters are here as well, for pipelines: vtkMultiLabelInterfaceMesher,
vtkMultiLabelCurveExtractor and vtkMultiLabelCurveProtector.
"""

from .exporting import write_volume
from .meshing import MeshError, mesh
from .readers import read
from .reporting import report
from .vtkMultiLabelInterfaceMesher import (
    vtkMultiLabelCurveExtractor,
    vtkMultiLabelCurveProtector,
    vtkMultiLabelImageAlgorithm,
    vtkMultiLabelInterfaceMesher,
)

__all__ = [
    "MeshError",
    "mesh",
    "read",
    "report",
    "vtkMultiLabelCurveExtractor",
    "vtkMultiLabelCurveProtector",
    "vtkMultiLabelImageAlgorithm",
    "vtkMultiLabelInterfaceMesher",
    "write_volume",
]
