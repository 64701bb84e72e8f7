"""Images from files, by VTK's readers."""

from __future__ import annotations

import contextlib
import importlib
import os
from typing import TYPE_CHECKING

from .running import collect_messages

if TYPE_CHECKING:
    from vtkmodules.vtkCommonDataModel import vtkImageData

# What a file's name ends in, and the reader: the module and class of VTK. A name may end in more
# than one of them; the longest counts.
_READERS = {
    ".vti": ("vtkIOXML", "vtkXMLImageDataReader"),
    ".pvti": ("vtkIOXML", "vtkXMLPImageDataReader"),
    ".vtk": ("vtkIOLegacy", "vtkStructuredPointsReader"),
    ".vtkhdf": ("vtkIOHDF", "vtkHDFReader"),
    ".nii": ("vtkIOImage", "vtkNIFTIImageReader"),
    ".nii.gz": ("vtkIOImage", "vtkNIFTIImageReader"),
    ".img": ("vtkIOImage", "vtkNIFTIImageReader"),
    ".img.gz": ("vtkIOImage", "vtkNIFTIImageReader"),
    ".hdr": ("vtkIOImage", "vtkNIFTIImageReader"),
    ".mha": ("vtkIOImage", "vtkMetaImageReader"),
    ".mhd": ("vtkIOImage", "vtkMetaImageReader"),
    ".nrrd": ("vtkIOImage", "vtkNrrdReader"),
    ".nhdr": ("vtkIOImage", "vtkNrrdReader"),
    ".mrc": ("vtkIOImage", "vtkMRCReader"),
    ".rec": ("vtkIOImage", "vtkMRCReader"),
    ".ali": ("vtkIOImage", "vtkMRCReader"),
    ".mnc": ("vtkIOMINC", "vtkMINCImageReader"),
    ".slc": ("vtkIOImage", "vtkSLCReader"),
    ".tif": ("vtkIOImage", "vtkTIFFReader"),
    ".tiff": ("vtkIOImage", "vtkTIFFReader"),
    ".dcm": ("vtkIOImage", "vtkDICOMImageReader"),
}
# Files of VTK that hold something else than an image, for a clearer sentence.
_OTHERS = (".vtp", ".vtu", ".vts", ".vtr", ".vtm", ".stl", ".ply", ".obj")
# Of the headers of images; more points than this a byte of the file is a header that lies. The best
# compression of a constant image is about 1000 to 1.
_MAX_POINTS_PER_BYTE = 100_000
# Headers of text have some dozens of short lines; data after them may have any.
_MAX_HEADER_LINE = 4096
_MAX_HEADER_FIELDS = 1000


def read(path: str | os.PathLike[str]) -> vtkImageData:
    """The image in a file, or in a folder of slices.

    Files: .vti, .pvti, .vtk (structured points), .vtkhdf, .nii, .nii.gz, .hdr and .img (NIFTI,
    Analyze), .mha, .mhd, .nrrd, .nhdr, .mrc, .rec, .ali, .mnc, .slc, .tif, .tiff (pages are
    slices), .dcm, and whatever else VTK's image readers recognise by its content. Folders: a DICOM
    series, or slices in files of one kind in the order of their names.

    Position and axes are those of a NIFTI file's matrix, and of the headers of MetaImage and NRRD
    files, in the coordinates of the file's own kind.

    Raises FileNotFoundError, ValueError for a file that is no image, and OSError with the reader's
    sentence if it cannot be read.
    """
    name = os.fspath(path)
    if not os.path.exists(name):
        raise FileNotFoundError(f"{name}: no such file")
    reader = _folder_reader(name) if os.path.isdir(name) else _file_reader(name)
    errors: list[str] = []
    collect_messages(reader, "ErrorEvent", errors)
    with _silence():
        reader.UpdateInformation()
        _check_header(reader, name, errors)
        reader.Update()
    image = reader.GetOutputDataObject(0)
    if image is not None and not image.IsA("vtkImageData"):
        raise ValueError(f"{name}: holds a {image.GetClassName()}, not an image")
    if errors or image is None or image.GetNumberOfPoints() == 0:
        raise OSError(f"{name}: {errors[0] if errors else 'holds no image'}")
    _place(reader, image, name)
    return image


def known_endings() -> tuple[str, ...]:
    """What the names of image files end in."""
    return tuple(_READERS)


def _file_reader(name: str):
    endings = [ending for ending in _READERS if name.lower().endswith(ending)]
    if endings:
        module, class_name = _READERS[max(endings, key=len)]
        try:
            reader = getattr(importlib.import_module(f"vtkmodules.{module}"), class_name)()
        except (ImportError, AttributeError):
            raise ValueError(f"{name}: this VTK was built without {class_name}") from None
    else:
        reader = None if name.lower().endswith(_OTHERS) else _recognise(name)
        if reader is None:
            raise ValueError(
                f"{name}: not an image that VTK can read; known are {', '.join(_READERS)}, "
                "folders of slices, and other files whose content VTK's image readers recognise"
            )
    reader.SetFileName(name)
    return reader


def _recognise(name: str):
    """A reader that recognises the file by its content, or None."""
    from vtkmodules.vtkIOImage import vtkDICOMImageReader, vtkImageReader2Factory

    with _silence():
        reader = vtkImageReader2Factory.CreateImageReader2(name)
        if reader is None:
            dicom = vtkDICOMImageReader()
            reader = dicom if dicom.CanReadFile(name) else None
    return reader


def _folder_reader(name: str):
    from vtkmodules.vtkCommonCore import vtkStringArray

    files = sorted(entry.path for entry in os.scandir(name) if entry.is_file())
    kinds = {os.path.splitext(file)[1].lower() for file in files}
    reader = _recognise(files[0]) if len(kinds) == 1 else None
    if reader is None:
        raise ValueError(f"{name}: neither a DICOM series nor slices in image files of one kind")
    if reader.IsA("vtkDICOMImageReader"):
        reader.SetDirectoryName(name)
        return reader
    names = vtkStringArray()
    for file in files:
        names.InsertNextValue(file)
    reader.SetFileNames(names)
    return reader


@contextlib.contextmanager
def _silence():
    """Within, nothing of VTK is printed: readers complain about files that are not theirs, and what
    helps them does so beside them."""
    from vtkmodules.vtkCommonCore import vtkLogger, vtkOutputWindow, vtkStringOutputWindow

    verbosity = vtkLogger.GetCurrentVerbosityCutoff()
    before = vtkOutputWindow.GetInstance()
    vtkOutputWindow.SetInstance(vtkStringOutputWindow())
    vtkLogger.SetStderrVerbosity(vtkLogger.VERBOSITY_OFF)
    try:
        yield
    finally:
        vtkLogger.SetStderrVerbosity(verbosity)
        vtkOutputWindow.SetInstance(before)


def _check_header(reader, name: str, errors: list[str]) -> None:
    """Refuses a header that promises more points than the file can hold, before memory is taken."""
    from vtkmodules.vtkCommonExecutionModel import vtkStreamingDemandDrivenPipeline

    information = reader.GetOutputInformation(0)
    key = vtkStreamingDemandDrivenPipeline.WHOLE_EXTENT()
    if errors or os.path.isdir(name) or not information.Has(key):
        return
    extent = [information.Get(key, i) for i in range(6)]
    points = 1
    for low, high in zip(extent[0::2], extent[1::2]):
        points *= max(high - low + 1, 0)
    # Headers with their data in another file are small.
    is_whole = name.lower().endswith((".vti", ".vtk", ".nii", ".nii.gz", ".mha", ".nrrd"))
    if is_whole and points > _MAX_POINTS_PER_BYTE * os.path.getsize(name):
        raise OSError(
            f"{name}: its header promises {points} points, more than {os.path.getsize(name)} bytes "
            "can hold"
        )


def _place(reader, image: vtkImageData, name: str) -> None:
    """Axes and, of NIFTI files, the position, which VTK's readers keep beside the image or pass
    over."""
    ending = name.lower().rsplit(".", 1)[-1]
    if reader.IsA("vtkNIFTIImageReader"):
        matrix = reader.GetSFormMatrix() or reader.GetQFormMatrix()
        if matrix is not None:
            columns = [[matrix.GetElement(r, c) for r in range(3)] for c in range(3)]
            if _turn(image, columns):
                image.SetSpacing([_length(column) for column in columns])
                image.SetOrigin([matrix.GetElement(r, 3) for r in range(3)])
    elif ending in ("mha", "mhd"):
        values = _header_of(name, "=").get("transformmatrix", "").split()
        if len(values) == 9:
            numbers = [float(value) for value in values]
            _turn(image, [numbers[0:3], numbers[3:6], numbers[6:9]])
    elif ending in ("nrrd", "nhdr"):
        vectors = _header_of(name, ":").get("space directions", "").replace(" ", "")
        rows = [row.strip("()").split(",") for row in vectors.split(")(")]
        if len(rows) == 3 and all(len(row) == 3 for row in rows):
            _turn(image, [[float(value) for value in row] for row in rows])


def _length(vector: list[float]) -> float:
    return sum(x * x for x in vector) ** 0.5


def _turn(image: vtkImageData, columns: list[list[float]]) -> bool:
    """Gives the image the axes along these vectors.

    Not if there is a shear: an image can be turned and mirrored, not sheared.
    """
    lengths = [_length(column) for column in columns]
    if min(lengths) == 0.0:
        return False
    axes = [[x / length for x in column] for column, length in zip(columns, lengths)]
    for a, b in ((0, 1), (1, 2), (2, 0)):
        if abs(sum(x * y for x, y in zip(axes[a], axes[b]))) > 1e-3:
            return False
    for r in range(3):
        for c in range(3):
            image.GetDirectionMatrix().SetElement(r, c, axes[c][r])
    return True


def _header_of(name: str, mark: str) -> dict[str, str]:
    """The fields of a header of text, up to an empty line or the one that names the data."""
    fields = {}
    with open(name, "rb") as file:
        for line in file:
            key, found, value = line[:_MAX_HEADER_LINE].decode("latin-1").partition(mark)
            if not line.strip() or len(fields) > _MAX_HEADER_FIELDS:
                break
            if found:
                fields[key.strip().lower()] = value.strip().lstrip("=")
            if key.strip() == "ElementDataFile":
                break
    return fields
