"""Images from files, by VTK's readers."""

from __future__ import annotations

import os
from typing import TYPE_CHECKING

if TYPE_CHECKING:
    from vtkmodules.vtkCommonDataModel import vtkImageData


def _xml_reader():
    from vtkmodules.vtkIOXML import vtkXMLImageDataReader

    return vtkXMLImageDataReader()


def _nifti_reader():
    from vtkmodules.vtkIOImage import vtkNIFTIImageReader

    return vtkNIFTIImageReader()


def _meta_reader():
    from vtkmodules.vtkIOImage import vtkMetaImageReader

    return vtkMetaImageReader()


def _nrrd_reader():
    from vtkmodules.vtkIOImage import vtkNrrdReader

    return vtkNrrdReader()


_READERS = {
    ".vti": _xml_reader,
    ".nii": _nifti_reader,
    ".nii.gz": _nifti_reader,
    ".mha": _meta_reader,
    ".mhd": _meta_reader,
    ".nrrd": _nrrd_reader,
}


def read(path: str | os.PathLike[str]) -> vtkImageData:
    """The image in a file: .vti, .nii, .nii.gz, .mha, .mhd or .nrrd.

    Raises FileNotFoundError, ValueError for another kind of file, and OSError if VTK's reader
    reports an error.
    """
    name = os.fspath(path)
    make = next((m for e, m in _READERS.items() if name.lower().endswith(e)), None)
    if make is None:
        raise ValueError(f"{name}: not one of the known kinds of file, {', '.join(_READERS)}")
    if not os.path.exists(name):
        raise FileNotFoundError(f"{name}: no such file")
    reader = make()
    errors: list[str] = []
    _collect_errors(reader, errors)
    reader.SetFileName(name)
    reader.Update()
    image = reader.GetOutput()
    if errors or image is None or image.GetNumberOfPoints() == 0:
        raise OSError(f"{name}: {errors[0] if errors else 'holds no image'}")
    if name.lower().endswith((".nii", ".nii.gz")):
        _place_nifti(reader, image)
    return image


def _collect_errors(algorithm, errors: list[str]) -> None:
    """Appends the text of error events to a list, and keeps VTK from printing them."""

    def keep(_caller, _event, text: str) -> None:
        # VTK's text is "ERROR: In FILE, line N\nvtkClass (0x...): sentence\n\n".
        sentence = text.strip().split("\n", 1)[-1]
        errors.append(sentence.split("): ", 1)[-1].strip())

    keep.CallDataType = "string0"
    algorithm.AddObserver("ErrorEvent", keep)
    algorithm.GetExecutive().AddObserver("ErrorEvent", keep)


def _place_nifti(reader, image: vtkImageData) -> None:
    """Position and axes of a NIFTI file, which VTK's reader keeps beside the image.

    A matrix with a shear stays unused: an image can be turned and mirrored, not sheared.
    """
    matrix = reader.GetSFormMatrix() or reader.GetQFormMatrix()
    if matrix is None:
        return
    columns = [[matrix.GetElement(r, c) for r in range(3)] for c in range(3)]
    lengths = [sum(x * x for x in column) ** 0.5 for column in columns]
    if min(lengths) == 0.0:
        return
    axes = [[x / length for x in column] for column, length in zip(columns, lengths)]
    for a, b in ((0, 1), (1, 2), (2, 0)):
        if abs(sum(x * y for x, y in zip(axes[a], axes[b]))) > 1e-3:
            return
    for r in range(3):
        for c in range(3):
            image.GetDirectionMatrix().SetElement(r, c, axes[c][r])
    image.SetSpacing(lengths)
    image.SetOrigin([matrix.GetElement(r, 3) for r in range(3)])
