"""The naive field, kept cell by cell: for images of so many labels that every array at every query
would take hours.

A label that is below another one at all corners of a cell is below it in the whole cell, so it wins
nowhere there. Every cell keeps the values of the labels that are left, and answers from them; the
answers are those of NaiveField, ties included.
"""

import numpy as np

from naive_field import BACKGROUND, NaiveField, corner_weights

# Cells at work at once; bounds the memory of a query.
CHUNK_CELLS = 1 << 18


def corner_views(values):
    """The eight corners of all cells, x + 2 y + 4 z, as views of grid values (z, y, x)."""
    ends = (slice(None, -1), slice(1, None))
    return [values[ends[z], ends[y], ends[x]] for z in (0, 1) for y in (0, 1) for x in (0, 1)]


def over_corners(values, extreme):
    """The smallest or largest corner value of each cell."""
    for axis in range(3):
        moved = np.moveaxis(values, axis, 0)
        values = np.moveaxis(extreme(moved[:-1], moved[1:]), 0, axis)
    return values


def above_lowest(values):
    """The box (slices) of all cells that have a corner above the smallest value, and that value."""
    floor = values.min()
    flags = values > floor
    box = []
    for axis in range(3):
        others = tuple(k for k in range(3) if k != axis)
        found = np.flatnonzero(flags.any(axis=others))
        if len(found) == 0:
            return tuple(slice(0, n - 1) for n in values.shape), floor
        last = values.shape[axis] - 1
        box.append(slice(max(found[0] - 1, 0), min(found[-1] + 1, last)))
    return tuple(box), floor


def grid_box(cells):
    return tuple(slice(s.start, s.stop + 1) for s in cells)


class CellField(NaiveField):
    """Drops the image's arrays once it has the labels of each cell."""

    def __init__(self, image):
        super().__init__(image)
        shape = tuple(self.dims[::-1] - 1)
        boxes = [above_lowest(values) for values in self.values]
        # Of each cell: the largest value that some label has or exceeds at all corners.
        bar = np.full(shape, max(floor for _, floor in boxes), self.values[0].dtype)
        for values, (box, _) in zip(self.values, boxes):
            lowest = over_corners(values[grid_box(box)], np.minimum)
            np.maximum(bar[box], lowest, out=bar[box])
        cells, labels, corners = [], [], []
        everyone = np.arange(bar.size).reshape(shape)
        for label, (values, (box, floor)) in enumerate(zip(self.values, boxes)):
            if (bar <= floor).any():
                box = tuple(slice(0, n) for n in shape)
            near = values[grid_box(box)]
            stays = over_corners(near, np.maximum) >= bar[box]
            cells.append(everyone[box][stays])
            labels.append(np.full(len(cells[-1]), label, np.int32))
            corners.append(np.stack([view[stays] for view in corner_views(near)], axis=1))
        self._keep(bar.size, np.concatenate(cells), np.concatenate(labels), corners)
        self.values = self._flat = None

    def _keep(self, cell_count, cells, labels, corners):
        """Candidates in the order of cells, and of labels in a cell."""
        corners = np.concatenate(corners)
        order = np.argsort(cells, kind="stable")
        self.count = np.bincount(cells, minlength=cell_count).astype(np.int32)
        self.first = np.cumsum(self.count, dtype=np.int64) - self.count
        self.label = labels[order]
        self.corner_values = corners[order]

    def _cell_of(self, indices):
        cells = np.clip(np.floor(indices).astype(np.int64), 0, np.maximum(self.dims - 2, 0))
        fractions = np.clip(indices - cells, 0.0, 1.0)
        sizes = self.dims - 1
        return cells[:, 0] + sizes[0] * (cells[:, 1] + sizes[1] * cells[:, 2]), fractions

    def _by_count(self, cells):
        """For each number of candidates: which of the cells have it, and their candidates."""
        counts = self.count[cells]
        for count in np.unique(counts).tolist():
            which = np.flatnonzero(counts == count)
            for begin in range(0, len(which), CHUNK_CELLS):
                part = which[begin : begin + CHUNK_CELLS]
                yield part, self.first[cells[part]][:, None] + np.arange(count)

    def labels_at(self, cells, fractions):
        """Index of the array that wins at `fractions` (N, 3) of the cells (N)."""
        result = np.empty(len(cells), np.int32)
        for part, candidates in self._by_count(cells):
            best = np.zeros(len(part), np.int64)
            if candidates.shape[1] > 1:
                weights = corner_weights(fractions[part])
                values = (self.corner_values[candidates] * weights[:, None]).sum(axis=2)
                best = values.argmax(axis=1)
            result[part] = self.label[candidates[np.arange(len(part)), best]]
        return result

    def ids_at(self, points):
        indices = self.to_index(points)
        result = np.full(len(indices), BACKGROUND)
        inside = np.flatnonzero(self._inside(indices))
        result[inside] = self.ids[self.labels_at(*self._cell_of(indices[inside]))]
        return result

    def plateau_cells(self):
        result = np.zeros(len(self.count), bool)
        several = np.flatnonzero(self.count > 1)
        for part, candidates in self._by_count(several):
            cells = several[part]
            values = self.corner_values[candidates]
            wins = (values == values.max(axis=1, keepdims=True)).any(axis=2)
            for a in range(values.shape[1]):
                for b in range(a + 1, values.shape[1]):
                    result[cells[wins[:, a] & (values[:, a] == values[:, b]).all(axis=1)]] = True
        return result.reshape(tuple(self.dims[::-1] - 1))

    def _first_change(self, start, end):
        """As NaiveField's; a label that overtakes first on an edge wins there, so every cell of the
        edge keeps it."""
        nx, ny = self.dims[0], self.dims[1]
        points = [np.stack([p % nx, p // nx % ny, p // (nx * ny)], axis=1) for p in (start, end)]
        cells, _ = self._cell_of(points[0].astype(float))
        corner = np.minimum(points[0], self.dims - 2)
        slots = [((p - corner) * (1, 2, 4)).sum(axis=1) for p in points]
        result = np.ones(len(start))
        for part, candidates in self._by_count(cells):
            values = self.corner_values[candidates].astype(float)
            rows = np.arange(len(part))
            before = values[rows, :, slots[0][part]]
            after = values[rows, :, slots[1][part]]
            owner = before.argmax(axis=1)
            lead_before = before[rows, owner][:, None] - before
            lead_after = after[rows, owner][:, None] - after
            others = np.arange(before.shape[1])
            overtaken = (lead_after < 0) | ((lead_after == 0) & (others < owner[:, None]))
            span = lead_before - lead_after
            t = np.where(overtaken & (span > 0), lead_before / np.where(span > 0, span, 1), 1.0)
            result[part] = t.min(axis=1)
        return result

    def sampled_volumes(self, samples=4):
        smallest = over_corners(self.grid_ids, np.minimum)
        mixed = smallest != over_corners(self.grid_ids, np.maximum)
        values, counts = np.unique(smallest[~mixed], return_counts=True)
        volumes = {int(label): 0.0 for label in self.ids}
        for label, count in zip(values.tolist(), counts.tolist()):
            volumes[label] += float(count)
        position = (np.arange(samples) + 0.5) / samples
        grid = np.stack(np.meshgrid(position, position, position), axis=-1).reshape(-1, 3)
        weights = corner_weights(grid).T
        won = np.zeros(len(self.ids))
        for _, candidates in self._by_count(np.flatnonzero(mixed)):
            step = max(1, CHUNK_CELLS // len(grid))
            for begin in range(0, len(candidates), step):
                rows = candidates[begin : begin + step]
                best = (self.corner_values[rows] @ weights).argmax(axis=1)
                labels = np.take_along_axis(self.label[rows], best, axis=1)
                won += np.bincount(labels.ravel(), minlength=len(won))
        for label, count in zip(self.ids.tolist(), (won / len(grid)).tolist()):
            volumes[label] += count
        return {label: volume * self.voxel_volume for label, volume in volumes.items()}
