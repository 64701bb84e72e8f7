"""Interface meshes of multi-label images.

    import mlim
    surface = mlim.mesh("atlas.vti", facet_size=2.0)
    print(mlim.report(surface))
    mlim.write(surface, "atlas.vtp")
    surface, volume = mlim.mesh("atlas.vti", facet_size=2.0, volume=True)
    mlim.write_volume(volume, "atlas.msh")

On the command line: python3 -m mlim atlas.vti -o atlas.vtp; --help says more.

The filters are here as well, for pipelines: vtkMultiLabelIndicators,
vtkMultiLabelCurveExtractor, vtkMultiLabelCurveProtector and vtkMultiLabelInterfaceMesher. mlim.update
runs one of them with progress, Ctrl-C and exceptions.
"""

from .exporting import write_volume
from .meshing import balls, curves, mesh
from .readers import read
from .reporting import report
from .running import MeshError, MeshWarning, update
from .version import __version__
from .vtkMultiLabelInterfaceMesher import (
    vtkMultiLabelCurveExtractor,
    vtkMultiLabelCurveProtector,
    vtkMultiLabelImageAlgorithm,
    vtkMultiLabelIndicators,
    vtkMultiLabelInterfaceMesher,
)
from .writers import write

__all__ = [
    "MeshError",
    "MeshWarning",
    "__version__",
    "balls",
    "curves",
    "mesh",
    "read",
    "report",
    "update",
    "vtkMultiLabelCurveExtractor",
    "vtkMultiLabelCurveProtector",
    "vtkMultiLabelImageAlgorithm",
    "vtkMultiLabelIndicators",
    "vtkMultiLabelInterfaceMesher",
    "write",
    "write_volume",
]
