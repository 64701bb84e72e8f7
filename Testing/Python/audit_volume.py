"""What is true of a volume mesh and its surface, measured from the outside.

Reads the two outputs as they are documented and shares no code with the mesher.
"""

import numpy as np
from vtkmodules.util.numpy_support import vtk_to_numpy

from audit import Surface, enclosed_volumes, half_edges
from naive_field import BACKGROUND, NaiveField

# The faces of a positively oriented tetrahedron, each seen from outside anticlockwise.
FACES = np.array([[1, 2, 3], [0, 3, 2], [0, 1, 3], [0, 2, 1]])
EDGES = np.array([[0, 1], [0, 2], [0, 3], [1, 2], [1, 3], [2, 3]])

# Where the surface itself is sharper than this, in degrees, cells cannot have good angles: wedges
# between its triangles inside a region, and the triangles' own angles.
SHARP_WEDGE = 30.0
SHARP_TRIANGLE = 15.0
# And where it comes nearer to itself than this, in lengths of its edges there: a film so thin has flat
# cells, however it is filled.
NARROW_GAP = 0.4
# A triangle's points whose distance from others stands for its own, as weights of its corners.
SAMPLES = np.array(
    [
        (1, 1, 1), (1, 1, 0), (0, 1, 1), (1, 0, 1), (8, 1, 1), (1, 8, 1), (1, 1, 8),
    ],
    float,
)

LIMITS = {
    "max_volume_error": 1e-9,
    "min_agreement": 0.99,
    "max_ratio": 2.0,
    "min_angle_away": 10.0,
    "min_angle": 3.0,
}


class Volume:
    """Arrays of a volume mesh."""

    def __init__(self, grid):
        self.points = vtk_to_numpy(grid.GetPoints().GetData()).astype(float)
        cells = grid.GetCells()
        offsets = vtk_to_numpy(cells.GetOffsetsArray())
        if len(offsets) > 1 and not (np.diff(offsets) == 4).all():
            raise AssertionError("a cell is not a tetrahedron")
        self.cells = vtk_to_numpy(cells.GetConnectivityArray()).reshape(-1, 4).astype(np.int64)
        self.labels = vtk_to_numpy(grid.GetCellData().GetArray("Label")).astype(np.int64)

    def corners(self):
        return [self.points[self.cells[:, k]] for k in range(4)]

    def volumes(self):
        a, b, c, d = self.corners()
        return np.einsum("ij,ij->i", b - a, np.cross(c - a, d - a)) / 6


def dihedral_angles(volume):
    """(cells, 6) degrees, at the edges in the order of EDGES."""
    corners = volume.corners()
    normals = []
    for face in FACES:
        a, b, c = (corners[k] for k in face)
        normals.append(np.cross(b - a, c - a))
    result = np.empty((len(volume.cells), 6))
    for e, (i, j) in enumerate(EDGES):
        k, l = EDGES[5 - e]
        cross = np.linalg.norm(np.cross(normals[k], normals[l]), axis=1)
        dot = np.einsum("ij,ij->i", normals[k], normals[l])
        result[:, e] = np.degrees(np.arctan2(cross, -dot))
    return result


def radius_edge_ratios(volume):
    p, q, r, s = volume.corners()
    a, b, c = q - p, r - p, s - p
    dots = [np.einsum("ij,ij->i", v, v)[:, None] for v in (a, b, c)]
    centre = dots[0] * np.cross(b, c) + dots[1] * np.cross(c, a) + dots[2] * np.cross(a, b)
    six = np.einsum("ij,ij->i", a, np.cross(b, c))
    radius = np.linalg.norm(centre, axis=1) / np.abs(2 * six)
    corners = volume.corners()
    lengths = [np.linalg.norm(corners[i] - corners[j], axis=1) for i, j in EDGES]
    return radius, radius / np.min(lengths, axis=0)


def conformity(volume, surface):
    """Faces against the surface's triangles."""
    faces = volume.cells[:, FACES].reshape(-1, 3)
    owners = np.repeat(np.arange(len(volume.cells)), 4)
    keys = np.sort(faces, axis=1)
    order = np.lexsort(keys.T)
    keys, owners = keys[order], owners[order]
    first = np.ones(len(keys), bool)
    first[1:] = (keys[1:] != keys[:-1]).any(axis=1)
    starts = np.flatnonzero(first)
    counts = np.diff(np.append(starts, len(keys)))
    labels = np.full((len(starts), 2), BACKGROUND)
    labels[:, 0] = volume.labels[owners[starts]]
    pairs = counts == 2
    labels[pairs, 1] = volume.labels[owners[starts[pairs] + 1]]
    boundary = (labels[:, 0] != labels[:, 1]) | (counts == 1)
    found = {tuple(k): tuple(sorted(l)) for k, l in zip(keys[starts[boundary]], labels[boundary])}
    wanted = {
        tuple(k): tuple(sorted(l))
        for k, l in zip(np.sort(surface.triangles, axis=1), surface.labels)
    }
    count = len(surface.points)
    return {
        "faces_of_three_cells": int((counts > 2).sum()),
        "moved_points": int((volume.points[:count] != surface.points).any(axis=1).sum()),
        "missing_triangles": sum(found.get(k) != v for k, v in wanted.items()),
        "extra_faces": sum(k not in wanted for k in found),
    }


def sharp_cells(volume, surface, angles):
    """Cells that share a vertex with a place where the surface is sharp."""
    sharp = np.zeros(len(volume.points), bool)
    corners = surface.corners()
    for k in range(3):
        u = corners[(k + 1) % 3] - corners[k]
        v = corners[(k + 2) % 3] - corners[k]
        angle = np.degrees(
            np.arctan2(np.linalg.norm(np.cross(u, v), axis=1), np.einsum("ij,ij->i", u, v))
        )
        sharp[surface.triangles[angle < SHARP_TRIANGLE].ravel()] = True
    # Wedges: the cells of one label at one edge of the surface.
    count = np.int64(len(volume.points))
    surface_edges = np.unique(edge_key(half_edges(surface.triangles)[0], count))
    cell_edges = np.sort(volume.cells[:, EDGES], axis=2).reshape(-1, 2)
    keys = edge_key(cell_edges, count)
    on_surface = np.isin(keys, surface_edges)
    labels = np.repeat(volume.labels, 6)[on_surface]
    keys = keys[on_surface]
    rows, inverse = np.unique(np.stack([keys, labels], axis=1), axis=0, return_inverse=True)
    wedges = np.bincount(inverse.ravel(), weights=angles.ravel()[on_surface])
    narrow = rows[wedges < SHARP_WEDGE, 0]
    sharp[narrow // count] = True
    sharp[narrow % count] = True
    return sharp[volume.cells].any(axis=1)


def narrow_gap(surface, vertex, samples):
    """Distance of a vertex to triangles that are not round it, in edge lengths there."""
    is_round = (surface.triangles == vertex).any(axis=1)
    ring = np.unique(surface.triangles[is_round])
    point = surface.points[vertex]
    lengths = np.linalg.norm(surface.points[ring[ring != vertex]] - point, axis=1)
    others = samples[~np.isin(surface.triangles, ring).any(axis=1)].reshape(-1, 3)
    if len(others) == 0 or len(lengths) == 0:
        return np.inf
    return np.linalg.norm(others - point, axis=1).min() / lengths.mean()


def in_narrow_gap(volume, surface, rows):
    """Which of the cells lie where the surface comes near itself. Slow: for a few cells."""
    weights = SAMPLES / SAMPLES.sum(axis=1, keepdims=True)
    samples = np.einsum("kc,tcx->tkx", weights, surface.points[surface.triangles])
    gaps = {}
    result = np.zeros(len(rows), bool)
    for k, row in enumerate(rows):
        for vertex in volume.cells[row][volume.cells[row] < len(surface.points)].tolist():
            if vertex not in gaps:
                gaps[vertex] = narrow_gap(surface, vertex, samples)
            result[k] |= gaps[vertex] < NARROW_GAP
    return result


def edge_key(edges, count):
    edges = np.sort(edges, axis=1).astype(np.int64)
    return edges[:, 0] * count + edges[:, 1]


def audit_volume(image, surface_data, grid):
    """Measures the volume against its surface (with caps and double points) and the image."""
    volume, surface = Volume(grid), Surface(surface_data)
    if len(volume.cells) == 0:
        raise AssertionError("the volume has no cell")
    sizes = volume.volumes()
    angles = dihedral_angles(volume)
    radii, ratios = radius_edge_ratios(volume)
    figures = conformity(volume, surface)
    centre = volume.points.mean(axis=0)
    enclosed = enclosed_volumes(surface, centre)
    errors = [
        abs(sizes[volume.labels == label].sum() / enclosed[label] - 1)
        for label in np.unique(volume.labels)
        if label != BACKGROUND
    ]
    regions = volume.labels != BACKGROUND
    field = NaiveField(image)
    centres = sum(volume.corners()) / 4
    agrees = field.ids_at(centres) == volume.labels
    types = vtk_to_numpy(surface_data.GetPointData().GetArray("NodeType"))
    is_ball = np.zeros(len(volume.points), bool)
    is_ball[: len(types)] = types % 10 != 2
    near_ball = is_ball[volume.cells].any(axis=1)
    near_sharp = sharp_cells(volume, surface, angles)
    suspects = np.flatnonzero(~near_sharp & ((angles.min(axis=1) < 10) | (ratios > 2) & ~near_ball))
    near_sharp[suspects] |= in_narrow_gap(volume, surface, suspects)
    figures.update(
        cells=len(volume.cells),
        points=len(volume.points),
        not_positive=int((~(sizes > 0)).sum()),
        unused_points=int(len(volume.points) - len(np.unique(volume.cells))),
        lost_regions=len(set(enclosed) - set(volume.labels.tolist()) - {BACKGROUND}),
        max_volume_error=max(errors, default=0.0),
        agreement=float(sizes[agrees & regions].sum() / sizes[regions].sum()),
        max_ratio=float(ratios[~near_ball].max(initial=0.0)),
        max_ratio_away=float(ratios[~near_ball & ~near_sharp].max(initial=0.0)),
        ratio_exceptions_away=int((ratios[~near_ball & ~near_sharp] > 2).sum()),
        ratio_exceptions=int((ratios[~near_ball] > 2).sum()),
        ball_ratio_exceptions=int((ratios[near_ball] > 2).sum()),
        min_angle=float(angles.min()),
        max_angle=float(angles.max()),
        min_angle_away=float(angles[~near_sharp].min(initial=180.0)),
        below_3=int((angles.min(axis=1) < 3).sum()),
        below_3_away=int((angles[~near_sharp].min(axis=1, initial=180.0) < 3).sum()),
        below_10=int((angles.min(axis=1) < 10).sum()),
        below_10_away=int((angles[~near_sharp].min(axis=1, initial=180.0) < 10).sum()),
        sharp_share=float(near_sharp.mean()),
        mean_min_angle=float(angles.min(axis=1).mean()),
        max_radius=float(radii.max()),
    )
    return figures


MUST_BE_ZERO = (
    "not_positive",
    "unused_points",
    "lost_regions",
    "faces_of_three_cells",
    "moved_points",
    "missing_triangles",
    "extra_faces",
)


def volume_failures(figures, **limits):
    """One sentence for each figure that is out of its limit."""
    bounds = {**LIMITS, **limits}
    result = [f"{name} is {figures[name]}, not 0" for name in MUST_BE_ZERO if figures[name] != 0]
    for name, limit, sign in (
        ("max_volume_error", "max_volume_error", -1),
        ("agreement", "min_agreement", 1),
        ("max_ratio", "max_ratio", -1),
        ("min_angle_away", "min_angle_away", 1),
        ("min_angle", "min_angle", 1),
    ):
        if sign * (figures[name] - bounds[limit]) < 0:
            word = "below" if sign > 0 else "above"
            result.append(f"{name} is {figures[name]:.6g}, {word} {bounds[limit]:g}")
    return result
