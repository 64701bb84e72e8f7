"""A multi-label image read the naive way: the label of a point is the argmax of the trilinear
interpolants, a tie goes to the lowest array, and all outside the image is background.

Written on numpy alone and knows nothing of the mesher, so that it can judge it.
"""

import re

import numpy as np
from vtkmodules.util.numpy_support import vtk_to_numpy

BACKGROUND = 0
# Points this far outside the box, in index units, still count as on it: rounding of world points.
BOX_TOLERANCE = 1e-9
# Values at work at once; bounds the memory of a query.
CHUNK_VALUES = 1 << 24


def is_background(name):
    return re.sub(r"[^a-z]", "", name.lower()) == "background"


def read_labels(image):
    """Names, ids and values (indexed z, y, x) of the single-component point arrays. Ids are those of
    the field data LabelIds, if it has one entry an array."""
    width, height, depth = image.GetDimensions()
    names, ids, values = [], [], []
    next_id = 1
    for index in range(image.GetPointData().GetNumberOfArrays()):
        array = image.GetPointData().GetArray(index)
        if array is None or array.GetNumberOfComponents() != 1:
            continue
        name = array.GetName() or ""
        if is_background(name) and BACKGROUND not in ids:
            ids.append(BACKGROUND)
        else:
            ids.append(next_id)
            next_id += 1
        names.append(name)
        values.append(vtk_to_numpy(array).reshape(depth, height, width))
    given = image.GetFieldData().GetArray("LabelIds")
    if given is not None and given.GetNumberOfValues() == len(ids):
        ids = vtk_to_numpy(given).astype(int).tolist()
    return names, np.array(ids), values


def corner_weights(fractions):
    """Trilinear weights (N, 8) of the corners x + 2 y + 4 z of a cell at `fractions` (N, 3)."""
    one = 1.0 - fractions
    x = np.stack([one[:, 0], fractions[:, 0]], axis=1)
    y = np.stack([one[:, 1], fractions[:, 1]], axis=1)
    z = np.stack([one[:, 2], fractions[:, 2]], axis=1)
    return (z[:, :, None, None] * y[:, None, :, None] * x[:, None, None, :]).reshape(-1, 8)


def extreme_filter(values, extreme):
    """Smallest or largest value of each 3x3x3 neighbourhood that lies in the grid."""
    for axis in range(3):
        moved = np.moveaxis(values, axis, 0)
        result = moved.copy()
        extreme(result[1:], moved[:-1], out=result[1:])
        extreme(result[:-1], moved[1:], out=result[:-1])
        values = np.moveaxis(result, 0, axis)
    return values


class NaiveField:
    """Labels of an image's points, its grid crossings, its thick regions and their volumes."""

    def __init__(self, image):
        self.names, self.ids, self.values = read_labels(image)
        if not self.values:
            raise ValueError("the image has no single-component point array")
        self.dims = np.array(image.GetDimensions())
        self.spacing = np.array(image.GetSpacing())
        self.origin = np.array(image.GetOrigin())
        self.start = np.array(image.GetExtent())[0::2]
        matrix = image.GetDirectionMatrix()
        self.direction = np.array(
            [[matrix.GetElement(r, c) for c in range(3)] for r in range(3)]
        )
        self.voxel_volume = float(np.prod(self.spacing))
        self.min_spacing = float(self.spacing.min())
        self._flat = [values.ravel() for values in self.values]
        self.grid_ids = self._argmax_on_grid()

    def _argmax_on_grid(self):
        best = self.values[0].copy()
        index = np.zeros(best.shape, np.int16)
        for k in range(1, len(self.values)):
            larger = self.values[k] > best
            index[larger] = k
            best[larger] = self.values[k][larger]
        return self.ids.astype(np.int32)[index]

    def to_index(self, points):
        """World points in continuous grid indices that start at 0, x first."""
        local = (np.asarray(points, float) - self.origin) @ np.linalg.inv(self.direction).T
        return local / self.spacing - self.start

    def to_world(self, indices):
        return ((indices + self.start) * self.spacing) @ self.direction.T + self.origin

    def corner_offsets(self):
        """Distance in the flat arrays from a cell's first corner to its eight corners."""
        row, plane = self.dims[0], self.dims[0] * self.dims[1]
        return np.array([x + y * row + z * plane for z in (0, 1) for y in (0, 1) for x in (0, 1)])

    def _inside(self, indices):
        return (
            (indices >= -BOX_TOLERANCE) & (indices <= self.dims - 1 + BOX_TOLERANCE)
        ).all(axis=1)

    def _cells(self, indices):
        cells = np.clip(np.floor(indices).astype(np.int64), 0, np.maximum(self.dims - 2, 0))
        fractions = np.clip(indices - cells, 0.0, 1.0)
        first = cells[:, 0] + self.dims[0] * (cells[:, 1] + self.dims[1] * cells[:, 2])
        return first, fractions

    def interpolate(self, indices):
        """Interpolants (labels, N) at points inside the box, given in grid indices."""
        first, fractions = self._cells(indices)
        corners = first[:, None] + self.corner_offsets()
        weights = corner_weights(fractions)
        return np.stack([(values[corners] * weights).sum(axis=1) for values in self._flat])

    def ids_at(self, points):
        """Label ids of world points."""
        indices = self.to_index(points)
        result = np.full(len(indices), BACKGROUND)
        inside = np.flatnonzero(self._inside(indices))
        step = max(1, CHUNK_VALUES // (8 * len(self._flat)))
        for begin in range(0, len(inside), step):
            part = inside[begin : begin + step]
            result[part] = self.ids[self.interpolate(indices[part]).argmax(axis=0)]
        return result

    def plateau_cells(self):
        """Cells (bool, z y x) in which two labels tie for the maximum everywhere."""
        cells = np.zeros(tuple(self.dims[::-1] - 1), bool)
        best = np.maximum.reduce(self.values)
        winners = sum((values == best).astype(np.uint8) for values in self.values)
        touched = extreme_filter((winners > 1).astype(np.uint8), np.maximum)[:-1, :-1, :-1] > 0
        z, y, x = np.nonzero(touched)
        corners = (x + self.dims[0] * (y + self.dims[1] * z))[:, None] + self.corner_offsets()
        top = best.ravel()[corners]
        at_corners = [values[corners] for values in self._flat]
        for a in range(len(at_corners)):
            wins = (at_corners[a] == top).any(axis=1)
            for b in range(a + 1, len(at_corners)):
                tied = wins & (at_corners[a] == at_corners[b]).all(axis=1)
                cells[z[tied], y[tied], x[tied]] = True
        return cells

    def on_plateau(self, points, margin=0.05):
        """Whether world points lie in a plateau cell, or within `margin` cells of one."""
        cells = self.plateau_cells()
        result = np.zeros(len(points), bool)
        if not cells.any():
            return result
        indices = self.to_index(points)
        last = np.array(cells.shape[::-1]) - 1
        for corner in np.ndindex(2, 2, 2):
            moved = indices + margin * (2 * np.array(corner) - 1)
            x, y, z = np.clip(np.floor(moved).astype(np.int64), 0, last).T
            result |= cells[z, y, x]
        return result

    def thick(self):
        """Grid points (bool, z y x) in a 3x3x3 block of one label, that is, in its opening."""
        smallest = extreme_filter(self.grid_ids, np.minimum)
        uniform = (smallest == extreme_filter(self.grid_ids, np.maximum)).astype(np.uint8)
        for axis in range(3):
            moved = np.moveaxis(uniform, axis, 0)
            moved[0] = moved[-1] = 0
        return extreme_filter(uniform, np.maximum) > 0

    def crossings(self):
        """Label changes on grid edges: world points, and whether both ends are thick."""
        thick = self.thick().ravel()
        ids = self.grid_ids.ravel()
        everyone = np.arange(ids.size).reshape(self.grid_ids.shape)
        points, flags = [], []
        for axis, stride in enumerate((1, self.dims[0], self.dims[0] * self.dims[1])):
            along = np.moveaxis(everyone, 2 - axis, 0)
            start = along[:-1].ravel()
            start = start[ids[start] != ids[start + stride]]
            indices = np.stack(np.unravel_index(start, self.grid_ids.shape)[::-1], axis=1)
            indices = indices.astype(float)
            indices[:, axis] += self._first_change(start, start + stride)
            points.append(self.to_world(indices))
            flags.append(thick[start] & thick[start + stride])
        return np.concatenate(points), np.concatenate(flags)

    def _first_change(self, start, end):
        """Where on the edges the label of `start` is first overtaken, from 0 to 1."""
        before = np.stack([values[start] for values in self._flat]).astype(float)
        after = np.stack([values[end] for values in self._flat]).astype(float)
        owner = before.argmax(axis=0)
        lead_before = np.take_along_axis(before, owner[None], 0) - before
        lead_after = np.take_along_axis(after, owner[None], 0) - after
        others = np.arange(len(self._flat))[:, None]
        overtaken = (lead_after < 0) | ((lead_after == 0) & (others < owner))
        span = lead_before - lead_after
        t = np.where(overtaken & (span > 0), lead_before / np.where(span > 0, span, 1), 1.0)
        return t.min(axis=0)

    def voxel_counts(self):
        """{id: number of grid points}."""
        ids, counts = np.unique(self.grid_ids, return_counts=True)
        return dict(zip(ids.tolist(), counts.tolist()))

    def voxel_volumes(self):
        """{id: volume} by counting; points on faces, edges, corners weigh 1/2, 1/4, 1/8."""
        weights = [np.ones(n) for n in self.dims[::-1]]
        for axis_weights in weights:
            axis_weights[0] = axis_weights[-1] = 0.5
        weight = weights[0][:, None, None] * weights[1][None, :, None] * weights[2][None, None, :]
        volumes = {}
        for label in np.unique(self.grid_ids).tolist():
            volumes[label] = float(weight[self.grid_ids == label].sum() * self.voxel_volume)
        return volumes

    def sampled_volumes(self, samples=4):
        """{id: volume} of the interpolants' argmax: samples^3 points in every mixed cell."""
        corners = [
            self.grid_ids[z : z - 1 or None, y : y - 1 or None, x : x - 1 or None]
            for z in (0, 1) for y in (0, 1) for x in (0, 1)
        ]
        mixed = np.zeros(corners[0].shape, bool)
        for corner in corners[1:]:
            mixed |= corner != corners[0]
        highest = int(self.ids.max()) + 1
        counts = np.bincount(corners[0][~mixed], minlength=highest).astype(float)
        z, y, x = np.nonzero(mixed)
        first = x + self.dims[0] * (y + self.dims[1] * z)
        position = (np.arange(samples) + 0.5) / samples
        grid = np.stack(np.meshgrid(position, position, position), axis=-1).reshape(-1, 3)
        weights = corner_weights(grid)
        step = max(1, CHUNK_VALUES // (len(grid) * len(self._flat)))
        for begin in range(0, len(first), step):
            at = first[begin : begin + step, None] + self.corner_offsets()
            values = np.stack([flat[at] @ weights.T for flat in self._flat])
            won = self.ids[values.argmax(axis=0)].ravel()
            counts += np.bincount(won, minlength=highest) / len(grid)
        return dict(enumerate((counts * self.voxel_volume).tolist()))
