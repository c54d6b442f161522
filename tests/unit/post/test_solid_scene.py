"""Pictures of structures in space: what hides what, where joints run, from where one looks."""

from __future__ import annotations

import numpy as np
import pytest
from synthetic.solid_runs import DEPTH, HEIGHT, box_contacts, solid_frames, solid_wall, write_solid_run
from synthetic.spatial import spatial_model

from dem_cli.core.geometry.polyhedron import box, hull
from dem_cli.core.geometry.rotation import quaternions, rotation_vectors, unturned
from dem_cli.results.output.paraview.vertices import placed_vertices, rest_vertices
from dem_cli.results.output.reader import read
from dem_cli.results.post import frame_measures
from dem_cli.results.post.scene.axonometry import Standpoint, axonometry, seen_from
from dem_cli.results.post.scene.hidden_surfaces import NOTHING, seen_surface, window_of
from dem_cli.results.post.scene.joint_strokes import strokes

FAR, MIDDLE, NEAR = -30.0, 0.0, 30.0


def at_rest(model):
    return model.centroids.copy(), unturned(model.n_blocks, 3)


def test_a_view_is_right_handed_and_has_z_upwards():
    for azimuth in (0.0, -60.0, 133.0):
        view = seen_from(azimuth, 25.0)
        np.testing.assert_allclose(np.stack(view) @ np.stack(view).T, np.eye(3), atol=1e-15)
        np.testing.assert_allclose(np.cross(view.right, view.up), view.eye, atol=1e-15)
        assert view.right[2] == 0.0 < view.up[2]


def test_the_reader_stands_where_the_wall_moves_to():
    """The wall runs along x and falls towards +y; one looks at its wide side."""
    model = solid_wall()
    frame = solid_frames(model)[-1]
    assert axonometry(model, frame).eye[1] > 0.7
    away = frame._replace(positions=2.0 * model.centroids - frame.positions)
    assert axonometry(model, away).eye[1] < -0.7
    assert axonometry(model, None, Standpoint(azimuth=90.0, elevation=0.0)).eye == pytest.approx([0.0, 1.0, 0.0])


def nearest_by_rays(view, faces, window):
    """Face that the ray through the middle of each pixel meets first: brute force over all of them."""
    rows, columns = window.shape
    found, best = np.full(window.shape, NOTHING), np.full(window.shape, -np.inf)
    y, x = np.meshgrid(*((np.arange(n) + 0.5) * window.pixel + window.low[k] for n, k in ((rows, 1), (columns, 0))),
                       indexing="ij")  # fmt: skip
    for i, face in enumerate(faces):
        loop = view.placed(face)
        normal = np.cross(loop[1] - loop[0], loop[2] - loop[0])
        if normal[2] <= 1e-12:
            continue
        inside = np.ones(window.shape, bool)
        for a, b in zip(loop, np.roll(loop, -1, axis=0)):
            inside &= (b[0] - a[0]) * (y - a[1]) - (b[1] - a[1]) * (x - a[0]) > 0.0
        depth = loop[0, 2] - (normal[0] * (x - loop[0, 0]) + normal[1] * (y - loop[0, 1])) / normal[2]
        nearer = inside & (depth > best)
        found[nearer], best[nearer] = i, depth[nearer]
    return found, best


def test_what_is_seen_is_what_rays_meet_first():
    """Random polyhedra through each other, from three sides."""
    random = np.random.default_rng(5)
    rays = random.normal(size=(12, 7, 3))
    rays /= np.linalg.norm(rays, axis=2, keepdims=True)
    solids = [hull(0.6 * corners + random.uniform(-1, 1, 3)) for corners in rays]
    model = spatial_model(solids)
    topology, corners = model.topology, rest_vertices(model)
    faces = np.split(corners[topology.face_corners], topology.face_starts[1:-1])
    for azimuth, elevation in ((20.0, 30.0), (-100.0, 0.0), (200.0, 80.0)):
        view = seen_from(azimuth, elevation)
        places = view.placed(corners)
        window = window_of(places[:, :2].min(axis=0), places[:, :2].max(axis=0), 150)
        seen = seen_surface(places, topology.face_starts, topology.face_corners, window)
        expected, depths = nearest_by_rays(view, faces, window)
        differs = seen.faces != expected
        assert differs.mean() < 1e-3  # of pixels whose middle lies on an edge to the last bit
        same = ~differs & (expected != NOTHING)
        np.testing.assert_allclose(seen.depths[same], depths[same], atol=1e-9)


def test_what_lies_behind_is_hidden():
    """Three slabs one behind the other: only points of the nearest are shown, and those beside it."""
    slabs = [box((0, y, 0), (1, y + 1, 1)) for y in (FAR, MIDDLE, NEAR)]
    model, view = spatial_model(slabs), seen_from(90.0, 0.0)  # the reader looks along −y
    places = view.placed(rest_vertices(model))
    window = window_of(places[:, :2].min(axis=0) - 0.5, places[:, :2].max(axis=0) + 0.5, 100)
    seen = seen_surface(places, model.topology.face_starts, model.topology.face_corners, window)
    points = np.array([(0.5, y + 1.0, 0.5) for y in (FAR, MIDDLE, NEAR)] + [(1.2, FAR, 0.5), (5.0, NEAR, 0.5)])
    assert seen.shown(view.placed(points), 1e-6).tolist() == [False, False, True, True, False]


def test_joints_are_drawn_around_the_face_that_blocks_share():
    """Of 1 × 0.4 m: its outline; a point in the middle is none of its corners."""
    model = spatial_model([box((0, 0, 0), (1, 0.4, 1)), box((0, 0, 1), (1, 0.4, 2))])
    contacts = box_contacts(model, *at_rest(model), 0.1)
    order = [2, 0, 3, 1]  # in any order
    middle = contacts.points.mean(axis=0)
    mixed = contacts._replace(**{name: values[order] for name, values in contacts._asdict().items()})
    centred = mixed._replace(**{name: np.concatenate([values, values[:1]]) for name, values in mixed._asdict().items()})
    centred.points[4] = middle
    for record in (contacts, mixed, centred):
        found = strokes(record)
        lengths = np.linalg.norm(found.ends - found.starts, axis=1)
        assert lengths.sum() == pytest.approx(2.8)
        assert sorted(np.round(lengths, 12)) == [0.2] * 4 + [0.5] * 4
        np.testing.assert_allclose(found.starts[:, 2], 1.0)
        for start, end, point in zip(found.starts, found.ends, found.points, strict=True):
            assert min(np.abs(place - record.points[point]).max() for place in (start, end)) == 0.0


def test_exaggerated_motion_in_space():
    """Displacements and rotation vectors times the factor; contact points stay on their block."""
    model = solid_wall()
    frame = solid_frames(model)[3]
    shown = frame_measures.scaled(model, frame, 50.0)
    moved, turned = (shape.positions - model.centroids for shape in (frame, shown)), (frame, shown)
    for small, large in (moved, (rotation_vectors(shape.orientations) for shape in turned)):
        np.testing.assert_allclose(large, 50.0 * small, atol=1e-12)
    again = box_contacts(model, shown.positions, shown.orientations, frame.load)
    np.testing.assert_allclose(shown.contacts.points, again.points, atol=1e-9)


def test_sizes_in_space():
    model = solid_wall(2, 3)
    assert frame_measures.size(model) == pytest.approx(np.linalg.norm([3.0, DEPTH, 2 * HEIGHT]))
    frame = solid_frames(model)[0]
    turned = quaternions(np.tile((0.0, 0.0, 0.3), (model.n_blocks, 1)))
    moved = frame._replace(orientations=turned)
    expected = placed_vertices(model, model.centroids, turned) - rest_vertices(model)
    assert frame_measures.largest_displacement(model, moved) == pytest.approx(np.linalg.norm(expected, axis=1).max())


def test_pictures_of_a_run_in_space(tmp_path):
    pytest.importorskip("matplotlib")
    from matplotlib.image import imread

    from dem_cli.results.post.run_pictures import draw_all

    model = solid_wall(3, 2)
    folder = write_solid_run(tmp_path, model, solid_frames(model, 4))
    written = [path.name for path in draw_all(folder, tmp_path, animate=True)]
    assert written == ["capacity.png", "collapse.png", "energy.png", "collapse.gif"]
    picture = imread(tmp_path / "collapse.png")[..., :3]
    assert (picture.min(axis=2) < 0.99).mean() > 0.2
    assert len(read(folder).frames) == 4


def test_plot_from_another_side(tmp_path):
    """From behind the wall its open joint is to be seen; a chart has no sides, nor has the plane."""
    pytest.importorskip("matplotlib")
    from click.testing import CliRunner
    from matplotlib.image import imread

    from dem_cli.app.cli.main import main
    from dem_cli.results.post import style

    def plot(*words):
        return CliRunner().invoke(main, ["plot", str(folder), *words])

    model = solid_wall(3, 2)
    folder = write_solid_run(tmp_path / "run", model, solid_frames(model, 4))
    magenta = np.array([int(style.STATE_COLOURS["open"][i : i + 2], 16) for i in (1, 3, 5)]) / 255.0
    seen = {}
    for azimuth in ("90", "-90"):
        path = tmp_path / f"{azimuth}.png"
        assert plot("--picture", "collapse", "-o", str(path), "--azimuth", azimuth).exit_code == 0
        seen[azimuth] = (np.abs(imread(path)[:900, :, :3] - magenta).max(axis=2) < 0.05).sum()
    assert seen["-90"] > 3 * seen["90"]
    refused = plot("-x", "displacement", "-y", "load", "--azimuth", "30")
    assert (refused.exit_code, "not for charts" in refused.output) == (2, True)
