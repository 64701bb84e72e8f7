"""What the plugin's tests share, inside ParaView's programs: the plugin, images, digests, messages."""

import hashlib
import os
import sys
import tempfile

from paraview import servermanager, simple
from paraview.vtk import vtkImageData
from paraview.vtk.util.numpy_support import numpy_to_vtk, vtk_to_numpy

EXAMPLE_DATA = os.environ["MLIM_EXAMPLE_DATA"]
SPHERES = os.path.join(EXAMPLE_DATA, "spheres.vti")


def load(remote=False):
    """Makes the plugin's filters functions of paraview.simple."""
    if not os.environ.get("DISPLAY"):
        print("skipped: no display")
        sys.exit(77)
    if remote or not hasattr(simple, "MultiLabelInterfaceMesher"):
        simple.LoadPlugin(os.environ["MLIM_PLUGIN"], remote=remote, ns=vars(simple))


def read(path=SPHERES):
    return simple.XMLImageDataReader(FileName=[path])


def fetch(proxy, port=0):
    return servermanager.Fetch(proxy, idx=port)


def digest(data):
    """Of points, cells and the arrays of points and cells."""
    state = hashlib.sha256()

    def add(array):
        state.update(array.GetName().encode() if array.GetName() else b"")
        state.update(vtk_to_numpy(array).tobytes())

    add(data.GetPoints().GetData())
    for cells in (data.GetVerts(), data.GetLines(), data.GetPolys()):
        if cells.GetNumberOfCells() > 0:
            add(cells.GetOffsetsArray())
            add(cells.GetConnectivityArray())
    for arrays in (data.GetPointData(), data.GetCellData()):
        for name in sorted(arrays.GetArrayName(i) for i in range(arrays.GetNumberOfArrays())):
            add(arrays.GetArray(name))
    return state.hexdigest()


def values(data, name, owner="CellData"):
    return vtk_to_numpy(getattr(data, "Get" + owner)().GetArray(name))


def make_image(arrays, size):
    """An image of {name: numpy array of size^3 values}."""
    image = vtkImageData()
    image.SetDimensions(size, size, size)
    for name, array in arrays.items():
        data = numpy_to_vtk(array, deep=True)
        data.SetName(name)
        image.GetPointData().AddArray(data)
    return image


def source_of(image):
    """A proxy whose output is this image."""
    producer = simple.TrivialProducer()
    producer.GetClientSideObject().SetOutput(image)
    producer.UpdatePipeline()
    return producer


def through_state_file(source):
    """The same source in a session that was loaded from a file."""
    simple.RenameSource("the source", source)
    with tempfile.TemporaryDirectory() as folder:
        path = os.path.join(folder, "state.pvsm")
        simple.SaveState(path)
        simple.ResetSession()
        simple.LoadState(path)
    return simple.FindSource("the source")
