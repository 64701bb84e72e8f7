"""Interface meshes of multi-label images.

    import mlim
    surface = mlim.mesh("atlas.vti", facet_size=2.0)
    print(mlim.report(surface))

The filters are here as well, for pipelines: vtkMultiLabelIndicators,
vtkMultiLabelCurveExtractor, vtkMultiLabelCurveProtector and vtkMultiLabelInterfaceMesher.
"""

from .meshing import MeshError, mesh
from .readers import read
from .reporting import report
from .vtkMultiLabelInterfaceMesher import (
    vtkMultiLabelCurveExtractor,
    vtkMultiLabelCurveProtector,
    vtkMultiLabelImageAlgorithm,
    vtkMultiLabelIndicators,
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
    "vtkMultiLabelIndicators",
    "vtkMultiLabelInterfaceMesher",
]
