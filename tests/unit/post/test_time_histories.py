"""Pictures of a made-up time history: what is drawn from which numbers."""

from __future__ import annotations

import sys

import numpy as np
import pytest
from synthetic import wall_frames, wall_model, wall_summary
from synthetic.shaking import COLLAPSE, MONITORS, shaken, write_shaking
from synthetic.tumbling import write_shaken_column

from dem_cli.errors import UsageError
from dem_cli.results.output.reader import read
from dem_cli.results.output.store import ResultWriter

pytest.importorskip("matplotlib")
from matplotlib.figure import Figure

from dem_cli.results.post import animation, histories, run_pictures, style, view_box


@pytest.fixture
def results(tmp_path):
    return read(write_shaking(tmp_path, 60))


@pytest.fixture
def figures(monkeypatch):
    """Figures as they are when they are saved."""
    kept: list[Figure] = []
    monkeypatch.setattr(Figure, "savefig", lambda figure, *args, **options: kept.append(figure))
    return kept


def test_one_panel_per_quantity_below_the_base(results, tmp_path, figures):
    histories.draw_histories(results, tmp_path / "histories.png")
    axes = figures[0].axes
    assert [axis.get_ylabel().split("\n")[0] for axis in axes] == [
        "base", "displacement", "rotation", "opening", "acceleration",
    ]  # fmt: skip
    lines = [[line.get_label() for line in axis.get_lines() if line.get_label() in MONITORS] for axis in axes]
    assert lines == [[], ["top displacement x", "top displacement y"], ["top rotation"], ["foot opening"],
                     ["top acceleration x"]]  # fmt: skip
    for axis in axes:
        assert any(np.allclose(line.get_xdata(), COLLAPSE) for line in axis.get_lines())
    before = shaken().times <= COLLAPSE
    largest = 1e3 * np.abs(shaken().monitors[before, 0]).max()  # mm
    assert largest < -axes[1].get_ylim()[0] < 1.3 * largest  # the fall flattens nothing


def test_the_ledger_over_time_has_every_damping(results, tmp_path, figures):
    from dem_cli.results.post.energy import draw_energy

    draw_energy(results, tmp_path / "energy.png")
    axis = figures[0].axes[0]
    lines = {line.get_label(): line for line in axis.get_lines()}
    assert {"friction", "dashpots", "mass damping", "local damping", "base and loads", "kinetic"} <= lines.keys()
    assert "maxwell" not in lines  # nothing was taken by it
    assert lines["dashpots"].get_xdata()[-1] == pytest.approx(5.0)
    assert axis.get_xlabel() == "time [s]"


def test_start_collapse_and_end(results):
    from dem_cli.results.post.collapse import _panels

    panels = _panels(results)
    assert [name for name, _ in panels] == ["start", "collapse", "end"]
    times = [frame.time for _, frame in panels]
    assert (times[0], times[2]) == (0.0, 5.0)
    assert abs(times[1] - COLLAPSE) < 5.0 / 59


@pytest.mark.parametrize("n", [10, 4000, 4001, 50_000])
def test_thinned_lines_keep_their_extremes(n):
    time = np.linspace(0.0, 1.0, n)
    values = np.random.default_rng(1).normal(size=n)
    x, y = histories.thinned(time, values)
    assert len(x) <= 4004
    assert (x[0], x[-1]) == (0.0, 1.0)
    assert (np.diff(x) > 0.0).all()
    assert (y.min(), y.max()) == (values.min(), values.max())


def test_animation(results, tmp_path):
    from PIL import Image

    path = tmp_path / "collapse.gif"
    animation.draw_animation(results, path)
    assert path.stat().st_size < 2e6
    with Image.open(path) as image:
        assert image.n_frames == 60
        seen, took = [], 0
        for i in range(59):
            image.seek(i)
            took += image.info["duration"]
        assert abs(took - 5000) <= 10  # ms: as long as it shook
        for i in (0, 59):
            image.seek(i)
            seen.append(np.array(image.convert("RGB")))
    stone = np.array([int(style.STONE[i : i + 2], 16) for i in (1, 3, 5)])
    places = [np.argwhere((picture == stone).all(axis=2)).mean(axis=0) for picture in seen]
    assert places[1][1] > places[0][1] + 20  # the wall has fallen to the right


def test_the_ground_is_seen_to_move_unless_it_goes_far(results):
    assert view_box.carried(results, 1.0)
    assert not view_box.carried(results, 10.0)
    far = results.series._replace(base=100.0 * results.series.base)
    assert not view_box.carried(type(results)(**{**vars(results), "series": far}), 1.0)


@pytest.mark.parametrize("n", [200, 20_000])
def test_a_rotation_that_goes_on_the_other_way_round_is_broken(n):
    """A block that spins about x: the component of its rotation vector jumps from π to −π."""
    time = np.linspace(0.0, 1.0, n)
    turned = 4.5 * np.pi * time
    values = (turned + np.pi) % (2.0 * np.pi) - np.pi
    x, y = histories.curve(time, values, "rotation")
    assert np.isnan(y).sum() == 2
    np.testing.assert_array_equal(np.isnan(x), np.isnan(y))
    steps = np.abs(np.diff(y))
    assert steps[np.isfinite(steps)].max() < 0.1
    assert not np.isnan(histories.curve(time, values, "displacement")[1]).any()


def test_three_components_of_the_base_are_told_apart(tmp_path, figures):
    """In the histories and below an animation; in the plane two were."""
    folder = write_shaken_column(tmp_path / "run", 3)
    found = read(folder)
    histories.draw_histories(found, tmp_path / "histories.png")
    lines = figures[0].axes[0].get_lines()
    drawn = {line.get_label(): line.get_color() for line in lines if line.get_label() in "xyz"}
    assert drawn == {"x": style.INK, "y": style.THRUST, "z": style.GREY}
    for name, line in zip("xyz", lines):
        np.testing.assert_array_equal(line.get_ydata(), found.series.base[:, 0, "xyz".index(name)])
    assert histories.base_colours(read(write_shaking(tmp_path, 2)).series) == [style.INK, style.GREY]
    animation.draw_animation(found, tmp_path / "collapse.gif")
    assert (tmp_path / "collapse.gif").stat().st_size > 1e4


def test_an_animation_of_other_runs(tmp_path):
    writer = ResultWriter(tmp_path, wall_model(), "", {})
    for frame in wall_frames(wall_model(), 6):
        writer.frame(frame)
    writer.close(wall_summary())
    assert run_pictures.draw_all(tmp_path, tmp_path, animate=True)[-1] == tmp_path / "collapse.gif"


def test_no_frames_no_animation(tmp_path):
    ResultWriter(tmp_path, wall_model(), "", {}).close(wall_summary())
    with pytest.raises(UsageError, match="nothing to animate"):
        animation.draw_animation(read(tmp_path), tmp_path / "collapse.gif")
    assert not (tmp_path / "collapse.gif").exists()


def test_without_pillow(results, tmp_path, monkeypatch):
    monkeypatch.setitem(sys.modules, "PIL", None)
    with pytest.raises(UsageError, match="needs Pillow"):
        animation.draw_animation(results, tmp_path / "collapse.gif")
    assert not (tmp_path / "collapse.gif").exists()
