"""The audit on meshes whose faults are known: it must pass the good ones and fail the broken ones.

The good mesh is made by hand: two boxes side by side in a background. Their faces are planes of
the grid, where the indicators are exactly 0, so that the interfaces are planes with sharp edges.
"""

import unittest

import numpy as np
from vtkmodules.util.numpy_support import numpy_to_vtk
from vtkmodules.vtkCommonCore import vtkPoints
from vtkmodules.vtkCommonDataModel import vtkCellArray, vtkImageData, vtkPolyData
from vtkmodules.vtkFiltersCore import vtkFlyingEdges3D

from audit import Surface, audit, check, distances_to_triangles, failures, near_interface
from cell_field import CellField
from naive_field import NaiveField, is_background

# The boxes in grid points: x from 5 to 18 and from 18 to 31; y and z from 5 to 18.
LEFT, MIDDLE, RIGHT, LOW, HIGH = 5, 18, 31, 5, 18
DIMS = (36, 23, 23)
SPACING = (0.75, 0.8, 1.0)
ORIGIN = (10.0, -3.0, 2.0)
START = (3, -2, 1)
MIRROR = (-1, 0, 0, 0, 0, 1, 0, 1, 0)
FACET_DISTANCE = 0.1


def make_image(values, direction=None):
    """An image of {name: array indexed z, y, x}."""
    depth, height, width = next(iter(values.values())).shape
    i, j, k = START
    image = vtkImageData()
    image.SetExtent(i, i + width - 1, j, j + height - 1, k, k + depth - 1)
    image.SetSpacing(SPACING)
    image.SetOrigin(ORIGIN)
    if direction is not None:
        image.SetDirectionMatrix(direction)
    for name, array in values.items():
        data = numpy_to_vtk(np.ascontiguousarray(array).ravel(), deep=True)
        data.SetName(name)
        image.GetPointData().AddArray(data)
    return image


def two_boxes_image(direction=None):
    z, y, x = np.indices(DIMS[::-1]).astype(np.float32)
    sides = np.minimum(np.minimum(y - LOW, HIGH - y), np.minimum(z - LOW, HIGH - z))
    left = np.minimum(np.minimum(x - LEFT, MIDDLE - x), sides)
    right = np.minimum(np.minimum(x - MIDDLE, RIGHT - x), sides)
    return make_image({"00_Background": 0 * x, "one": left, "two": right}, direction)


class Mesh:
    """Triangles and curve edges under construction; points are shared by their grid indices."""

    def __init__(self):
        self.ids = {}
        self.triangles, self.labels, self.curve_edges = [], [], []

    def point(self, index):
        return self.ids.setdefault(tuple(index), len(self.ids))

    def add_face(self, axis, value, ranges, labels, outward):
        """Squares of one grid step on the plane `axis` = value; the normal along outward * axis."""
        u, v = (axis + 1) % 3, (axis + 2) % 3
        for a in range(*ranges[0]):
            for b in range(*ranges[1]):
                corners = []
                for p, q in ((a, b), (a + 1, b), (a + 1, b + 1), (a, b + 1)):
                    index = [0, 0, 0]
                    index[axis], index[u], index[v] = value, p, q
                    corners.append(self.point(index))
                if outward < 0:
                    corners.reverse()
                self.triangles += [[corners[k] for k in part] for part in ((0, 1, 2), (0, 2, 3))]
                self.labels += [labels] * 2

    def add_curve(self, indices):
        ids = [self.point(index) for index in indices]
        self.curve_edges += list(zip(ids, ids[1:] + ids[:1]))

    def to_polydata(self, field):
        world = field.to_world(np.array(list(self.ids), float))
        triangles = np.array(self.triangles)
        if np.linalg.det(field.direction) < 0:
            triangles = triangles[:, ::-1]
        types = np.full(len(world), 2)
        types[np.array(self.curve_edges).ravel()] = 3
        return make_surface(world, triangles, self.labels, self.curve_edges, types)


def make_surface(points, triangles, labels, curve_edges, types):
    surface = vtkPolyData()
    vertices = vtkPoints()
    vertices.SetData(numpy_to_vtk(np.ascontiguousarray(points, float), deep=True))
    surface.SetPoints(vertices)
    for rows, put in ((curve_edges, surface.SetLines), (triangles, surface.SetPolys)):
        cells = vtkCellArray()
        for row in np.asarray(rows).tolist():
            cells.InsertNextCell(len(row), row)
        put(cells)
    everything = [[-1, -1]] * len(curve_edges) + np.asarray(labels).tolist()
    for name, values, owner in (
        ("BoundaryLabels", np.array(everything, np.int32), surface.GetCellData()),
        ("NodeType", np.array(types, np.int32), surface.GetPointData()),
    ):
        array = numpy_to_vtk(values, deep=True)
        array.SetName(name)
        owner.AddArray(array)
    return surface


def two_boxes_surface(image):
    mesh = Mesh()
    for label, begin, end in ((1, LEFT, MIDDLE), (2, MIDDLE, RIGHT)):
        along, across = (begin, end), (LOW, HIGH)
        for side, outward in ((LOW, -1), (HIGH, 1)):
            mesh.add_face(1, side, (across, along), [label, 0], outward)
            mesh.add_face(2, side, (along, across), [label, 0], outward)
    mesh.add_face(0, LEFT, ((LOW, HIGH), (LOW, HIGH)), [1, 0], -1)
    mesh.add_face(0, RIGHT, ((LOW, HIGH), (LOW, HIGH)), [2, 0], 1)
    mesh.add_face(0, MIDDLE, ((LOW, HIGH), (LOW, HIGH)), [1, 2], 1)
    steps = range(LOW, HIGH)
    mesh.add_curve(
        [(MIDDLE, s, LOW) for s in steps]
        + [(MIDDLE, HIGH, s) for s in steps]
        + [(MIDDLE, LOW + HIGH - s, HIGH) for s in steps]
        + [(MIDDLE, LOW, LOW + HIGH - s) for s in steps]
    )
    return mesh.to_polydata(NaiveField(image))


def parts(surface):
    """The surface's points, triangles, labels, curve edges and node types, as numpy copies."""
    mesh = Surface(surface)
    return [
        np.copy(v)
        for v in (mesh.points, mesh.triangles, mesh.labels, mesh.curve_edges, mesh.node_types)
    ]


class TestGoodMeshes(unittest.TestCase):
    def test_two_boxes(self):
        image = two_boxes_image()
        figures = audit(image, two_boxes_surface(image), FACET_DISTANCE)
        check(figures)
        self.assertLess(figures["max_volume_difference"], 1e-9)
        self.assertEqual(figures["vertex_share"], 1.0)
        self.assertEqual(figures["normal_share"], 1.0)
        self.assertEqual(figures["curve_edges"], 4 * (HIGH - LOW))
        self.assertEqual(figures["curve_edges_with_two_triangles"], 0)

    def test_mirrored_direction(self):
        image = two_boxes_image(MIRROR)
        figures = audit(image, two_boxes_surface(image), FACET_DISTANCE)
        check(figures)
        self.assertLess(figures["max_volume_difference"], 1e-9)

    def test_contour_of_a_ball(self):
        z, y, x = np.indices((24, 24, 24)) - 11.3
        depth = 8.2 - np.sqrt(x * x + y * y + z * z)
        image = make_image({"background": 0 * depth, "ball": depth})
        contour = vtkFlyingEdges3D()
        image.GetPointData().SetActiveScalars("ball")
        contour.SetInputData(image)
        contour.SetValue(0, 0.0)
        contour.ComputeNormalsOff()
        contour.Update()
        output = contour.GetOutput()
        labels = numpy_to_vtk(
            np.tile(np.array([[1, 0]], np.int32), (output.GetNumberOfPolys(), 1)), deep=True
        )
        labels.SetName("BoundaryLabels")
        output.GetCellData().AddArray(labels)
        types = numpy_to_vtk(np.full(output.GetNumberOfPoints(), 2, np.int32), deep=True)
        types.SetName("NodeType")
        output.GetPointData().AddArray(types)
        figures = audit(image, output, 0.2)
        check(figures, max_ratio_exception_share=1.0)
        self.assertGreater(figures["max_ratio"], 1.0)
        self.assertLess(figures["max_counted_volume_difference"], 0.02)


class TestBrokenMeshes(unittest.TestCase):
    def setUp(self):
        self.image = two_boxes_image()
        self.good = parts(two_boxes_surface(self.image))

    def expect(self, word, points, triangles, labels, curve_edges, types):
        surface = make_surface(points, triangles, labels, curve_edges, types)
        found = failures(audit(self.image, surface, FACET_DISTANCE))
        self.assertTrue(any(word in text for text in found), f"{word} not in {found}")

    def test_missing_triangle(self):
        points, triangles, labels, edges, types = self.good
        self.expect("open_edges", points, triangles[1:], labels[1:], edges, types)

    def test_flipped_triangle(self):
        points, triangles, labels, edges, types = self.good
        triangles[7] = triangles[7][::-1]
        self.expect("incoherent_edges", points, triangles, labels, edges, types)

    def test_all_flipped(self):
        points, triangles, labels, edges, types = self.good
        self.expect("normal_share", points, triangles[:, ::-1], labels, edges, types)

    def test_duplicate_triangle(self):
        points, triangles, labels, edges, types = self.good
        triangles, labels = np.vstack([triangles, triangles[:1]]), np.vstack([labels, labels[:1]])
        self.expect("duplicate_triangles", points, triangles, labels, edges, types)

    def test_repeated_vertex(self):
        points, triangles, labels, edges, types = self.good
        triangles[3, 0] = triangles[3, 1]
        self.expect("degenerate", points, triangles, labels, edges, types)

    def test_swapped_labels(self):
        points, triangles, labels, edges, types = self.good
        self.expect("bad_label_pairs", points, triangles, labels[:, ::-1], edges, types)

    def test_foreign_label(self):
        points, triangles, labels, edges, types = self.good
        labels[labels[:, 1] == 0, 0] = 1
        self.expect("open_edges", points, triangles, labels, edges, types)

    def test_unused_point(self):
        points, triangles, labels, edges, types = self.good
        points, types = np.vstack([points, [[0, 0, 0]]]), np.append(types, 2)
        self.expect("unused_points", points, triangles, labels, edges, types)

    def test_duplicate_point(self):
        points, triangles, labels, edges, types = self.good
        points, types = np.vstack([points, points[:1]]), np.append(types, 2)
        triangles[0][triangles[0] == 0] = len(points) - 1
        self.expect("duplicate_points", points, triangles, labels, edges, types)

    def test_edge_missing_from_curve(self):
        points, triangles, labels, edges, types = self.good
        self.expect("multiple_edges_off_curves", points, triangles, labels, edges[1:], types)

    def test_line_off_the_extracted_curves(self):
        surface = make_surface(*self.good)
        curves = np.zeros(surface.GetNumberOfCells(), np.int32)
        curves[0] = -1
        array = numpy_to_vtk(curves, deep=True)
        array.SetName("CurveId")
        surface.GetCellData().AddArray(array)
        found = failures(audit(self.image, surface, FACET_DISTANCE))
        self.assertTrue(any("off_curve_share" in text for text in found), found)

    def test_curve_off_the_mesh(self):
        points, triangles, labels, edges, types = self.good
        edges = np.vstack([edges, [[0, len(points) - 1]]])
        self.expect("curve_edges_without", points, triangles, labels, edges, types)

    def test_moved_mesh(self):
        points, triangles, labels, edges, types = self.good
        points += 0.3
        self.expect("vertex_share", points, triangles, labels, edges, types)
        self.expect("centre_share", points, triangles, labels, edges, types)
        self.expect("crossing_share", points, triangles, labels, edges, types)

    def test_lost_label(self):
        points, triangles, labels, edges, types = self.good
        keep = (labels != 2).all(axis=1)
        self.expect("max_lost_label_voxels", points, triangles[keep], labels[keep], edges, types)

    def test_flat_triangles(self):
        points, triangles, labels, edges, types = self.good
        points[:, 0] = 12.0 + 0.2 * (points[:, 0] - 12.0)
        self.expect("ratio_exception_share", points, triangles, labels, edges, types)

    def test_wrong_volume(self):
        points, triangles, labels, edges, types = self.good
        surface = make_surface(1.1 * points, triangles, labels, edges, types)
        figures = audit(self.image, surface, FACET_DISTANCE)
        self.assertGreater(figures["max_volume_difference"], 0.3)
        self.assertIn("max_volume_difference", " ".join(failures(figures)))


class TestDistances(unittest.TestCase):
    def test_distance_to_triangles(self):
        """Above a face the distance is a coordinate; beside an edge that of two."""
        image = two_boxes_image()
        mesh, field = Surface(two_boxes_surface(image)), NaiveField(image)
        low, high = (LEFT + 1, LOW + 1, HIGH), (RIGHT - 1, HIGH - 1, HIGH + 2)
        at = np.random.default_rng(1).uniform(low, high, (99, 3))
        points = field.to_world(at)
        found = distances_to_triangles(mesh, points, 10.0)
        self.assertTrue(np.allclose(found, (at[:, 2] - HIGH) * SPACING[2]))
        beside = field.to_world(np.array([[8.5, LOW - 1.0, HIGH + 1.0]]))
        expected = np.hypot(SPACING[1], SPACING[2])
        self.assertAlmostEqual(distances_to_triangles(mesh, beside, 10.0)[0], expected)
        self.assertTrue(np.isinf(distances_to_triangles(mesh, beside, 0.99 * expected)[0]))

    def test_near_interface(self):
        field = NaiveField(two_boxes_image())
        at = field.to_world(np.array([[8.3, 9.4, 0.0]] * 4))
        at[:, 2] = field.to_world(np.array([[0, 0, float(HIGH)]]))[0, 2] + (0.0, 0.1, -0.1, 0.3)
        self.assertEqual(near_interface(field, at, 0.2).tolist(), [True, True, True, False])
        self.assertEqual(near_interface(field, at, 0.05).tolist(), [True, False, False, False])


class TestNaiveField(unittest.TestCase):
    def test_background_names(self):
        for name in ("background", "000_Background", "BACK-GROUND 1"):
            self.assertTrue(is_background(name), name)
        for name in ("", "ground", "background_left"):
            self.assertFalse(is_background(name), name)

    def test_world_and_index(self):
        field = NaiveField(two_boxes_image(MIRROR))
        indices = np.array([[0.0, 0.0, 0.0], [3.25, 4.5, 5.75], [35, 22, 22]])
        self.assertTrue(np.allclose(field.to_index(field.to_world(indices)), indices))
        image = two_boxes_image(MIRROR)
        point = [0.0, 0.0, 0.0]
        image.TransformContinuousIndexToPhysicalPoint(6.25, 2.5, 6.75, point)
        self.assertTrue(np.allclose(field.to_index([point])[0], (3.25, 4.5, 5.75)))

    def test_interpolants(self):
        values = np.arange(2 * 8.0).reshape(2, 2, 2, 2) ** 2
        field = NaiveField(make_image({"a": values[0], "b": values[1]}))
        at = np.array([[0.25, 0.5, 0.75]])
        for label in (0, 1):
            expected = 0.0
            for k, j, i in np.ndindex(2, 2, 2):
                share = [1 - f if c == 0 else f for c, f in zip((i, j, k), at[0])]
                expected += np.prod(share) * values[label, k, j, i]
            self.assertAlmostEqual(field.interpolate(at)[label, 0], expected)

    def test_outside_is_background(self):
        ones = np.ones((3, 3, 3))
        field = NaiveField(make_image({"a": ones, "b": 2 * ones}))
        points = field.to_world(np.array([[1, 1, 1], [2, 2, 2], [2.01, 1, 1], [-0.01, 1, 1.0]]))
        self.assertEqual(field.ids_at(points).tolist(), [2, 2, 0, 0])

    def test_plateau(self):
        a, b = np.zeros((4, 4, 6)), np.zeros((4, 4, 6))
        a[:, :, :2], b[:, :, 4:] = 1.0, 1.0
        field = NaiveField(make_image({"background": 0 * a - 1, "a": a, "b": b}))
        self.assertEqual(np.nonzero(field.plateau_cells().any(axis=(0, 1)))[0].tolist(), [2])
        points = field.to_world(np.array([[2.5, 1.0, 1.0], [0.5, 1.0, 1.0]]))
        self.assertEqual(field.on_plateau(points).tolist(), [True, False])

    def test_thick_and_thin(self):
        a = np.full((9, 9, 9), -1.0)
        a[1:4, 1:4, 1:4] = 1.0
        a[6:8, 1:8, 1:8] = 1.0
        field = NaiveField(make_image({"background": 0 * a, "a": a}))
        thick = field.thick() & (field.grid_ids == 1)
        self.assertEqual(int(thick.sum()), 27)
        self.assertTrue(thick[1:4, 1:4, 1:4].all())

    def test_crossings(self):
        a = np.full((3, 3, 3), -1.0)
        a[1, 1, 1] = 3.0
        field = NaiveField(make_image({"background": 0 * a, "a": a}))
        points, is_thick = field.crossings()
        offsets = np.abs(field.to_index(points) - 1)
        self.assertEqual(len(points), 6)
        self.assertFalse(is_thick.any())
        self.assertTrue(np.allclose(np.sort(offsets, axis=1), [0, 0, 0.75]))

    def test_voxel_weights(self):
        ones = np.ones((4, 5, 6))
        field = NaiveField(make_image({"a": ones}))
        self.assertAlmostEqual(field.voxel_volumes()[1], 3 * 4 * 5 * field.voxel_volume)
        self.assertAlmostEqual(field.sampled_volumes()[1], 3 * 4 * 5 * field.voxel_volume)


class TestCellField(unittest.TestCase):
    """It answers as the naive field does, which asks every array."""

    def expect_same(self, values, direction=None):
        image = make_image(values, direction)
        naive, field = NaiveField(image), CellField(image)
        low, high = -np.ones(3), np.array(image.GetDimensions())
        points = naive.to_world(np.random.default_rng(2).uniform(low, high, (4000, 3)))
        # On the grid's faces and points as well, where neighbouring cells have to agree.
        for at in (points, naive.to_world(np.round(2 * naive.to_index(points)) / 2)):
            self.assertTrue(np.array_equal(naive.ids_at(at), field.ids_at(at)))
        self.assertTrue(np.array_equal(naive.plateau_cells(), field.plateau_cells()))
        for ours, theirs in zip(naive.crossings(), field.crossings()):
            self.assertTrue(np.array_equal(ours, theirs))
        volumes = naive.sampled_volumes()
        self.assertEqual(
            {k: v for k, v in volumes.items() if v > 0},
            {k: v for k, v in field.sampled_volumes().items() if v > 0},
        )
        self.assertEqual(naive.voxel_volumes(), field.voxel_volumes())

    def test_two_boxes(self):
        image = two_boxes_image(MIRROR)
        arrays = image.GetPointData()
        values = {arrays.GetArrayName(k): NaiveField(image).values[k] for k in range(3)}
        self.expect_same(values, MIRROR)

    def test_many_labels_with_ties(self):
        """A coarse lattice of values makes ties and plateaus; each label has a box of its own."""
        random = np.random.default_rng(3)
        values = {}
        for label in range(12):
            array = np.full((7, 8, 9), -1.0, np.float32)
            x, y, z = random.integers(0, 5, 3)
            array[z : z + 3, y : y + 4, x : x + 4] = random.integers(-1, 3, (3, 4, 4))[
                : 7 - z, : 8 - y, : 9 - x
            ]
            values[f"label{label}"] = array
        self.expect_same(values)

    def test_labels_everywhere(self):
        random = np.random.default_rng(4)
        self.expect_same({f"label{k}": random.normal(size=(6, 6, 6)) for k in range(5)})

    def test_different_smallest_values(self):
        ones = np.ones((4, 5, 6))
        ramp = np.arange(6.0) + 0 * ones
        self.expect_same({"low": -9 * ones, "flat": 2.5 * ones, "ramp": ramp})


if __name__ == "__main__":
    unittest.main()
