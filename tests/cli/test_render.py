"""`dem render`: what is in the picture, and one clear message where nothing can be drawn."""

from __future__ import annotations

import multiprocessing
import os
import subprocess
import sys
import time
from pathlib import Path

import numpy as np
import pytest
from click.testing import CliRunner
from synthetic import HEIGHT, LENGTH, history_rows, wall_frames, wall_model, wall_summary
from synthetic.shaking import write_shaking
from synthetic.solid_runs import DEPTH as WALL_DEPTH
from synthetic.solid_runs import HEIGHT as WALL_HEIGHT
from synthetic.solid_runs import LENGTH as WALL_LENGTH
from synthetic.solid_runs import solid_frames, solid_wall, write_solid_run

from dem_cli.app.cli.main import main
from dem_cli.errors import OutputError, UsageError
from dem_cli.results.output.reader import read
from dem_cli.results.output.store import ResultWriter

pytest.importorskip("pyvista")
pytest.importorskip("matplotlib")
from PIL import Image

from dem_cli.results.post import style
from dem_cli.results.post.scene.axonometry import Standpoint
from dem_cli.results.render import block_colours, movie, opengl, render
from dem_cli.results.render.render import RenderOptions
from dem_cli.results.render.sheet import Sheet, layout
from dem_cli.results.render.view import view_of

ROOT = Path(__file__).resolve().parents[2]
ASK = "from dem_cli.results.render.opengl import choose_window; choose_window()"


@pytest.fixture(scope="module")
def graphics():
    """Skips where nothing can be rendered; continuous integration has what is needed."""
    asked = subprocess.run([sys.executable, "-c", ASK], capture_output=True, text=True)
    if asked.returncode:
        (pytest.fail if os.environ.get("CI") else pytest.skip)(f"no graphics libraries: {asked.stderr[-300:]}")


@pytest.fixture(scope="module")
def folder(tmp_path_factory):
    target = tmp_path_factory.mktemp("run")
    model = wall_model()
    frames = wall_frames(model, 6)
    writer = ResultWriter(target, model, "", {}, ["top"])
    for row in history_rows(frames):
        writer.row(row)
    for frame in frames:
        writer.frame(frame)
    writer.close(wall_summary())
    return target


@pytest.fixture(scope="module")
def solid_folder(tmp_path_factory):
    model = solid_wall(3, 2)
    return write_solid_run(tmp_path_factory.mktemp("space"), model, solid_frames(model, 4))


def dem(*arguments):
    result = CliRunner().invoke(main, [str(a) for a in arguments])
    return result.exit_code, result.output


def near(picture, colour, within=12):
    """Pixels of about this colour."""
    wanted = np.array([int(colour[i : i + 2], 16) for i in (1, 3, 5)])
    return np.abs(picture.astype(int) - wanted).max(axis=-1) <= within


def drawn(folder, monkeypatch, width=600, **look):
    """A page, rendered in this process."""
    monkeypatch.setenv("VTK_DEFAULT_OPENGL_WINDOW", os.environ.get("VTK_DEFAULT_OPENGL_WINDOW", ""))
    opengl.choose_window()
    look = RenderOptions(**look)
    results = read(folder)
    return render.draw(results, render.chosen(results, look.frame), look, width)[0]


def test_blocks_have_their_size(graphics, folder, monkeypatch):
    """Front view at true scale: the area of all pixels that are not paper is that of the blocks."""
    page = drawn(folder, monkeypatch, frame="0", joints=False, scale=1.0)
    stone = (page[44:] < 250).any(axis=-1)
    top, bottom = np.flatnonzero(stone.any(axis=1))[[0, -1]]
    metre = stone[top + 40].sum() / (3 * LENGTH)  # pixels: the base is cut off at the sides
    assert (bottom - top + 1) / metre == pytest.approx(7 * HEIGHT, rel=0.01)
    wall = stone[top : top + round(6 * HEIGHT * metre)]
    assert wall.sum() / metre**2 == pytest.approx(6 * HEIGHT * 3 * LENGTH, rel=0.01)


def test_joints_are_coloured_by_state(graphics, folder, monkeypatch):
    page = drawn(folder, monkeypatch, frame="last")
    body = page[70:-40]  # without the legend
    assert near(body, style.STATE_COLOURS["open"]).sum() > 100
    assert near(body, style.STATE_COLOURS["sliding"]).sum() > 100
    bare = drawn(folder, monkeypatch, frame="last", joints=False)
    assert not near(bare, style.STATE_COLOURS["open"]).any()


def test_forces_and_colours_in_an_oblique_view(graphics, folder, monkeypatch):
    plain = drawn(folder, monkeypatch, standpoint=Standpoint("3d"), frame="2")
    forces = drawn(folder, monkeypatch, standpoint=Standpoint("3d"), frame="2", forces="arrows", colour="rotation")
    blue = (forces[..., 2].astype(int) - forces[..., 0] > 60)[70:-60]
    assert blue.sum() > 200
    assert not (plain[..., 2].astype(int) - plain[..., 0] > 60)[70:-60].any()


def test_a_wall_in_space_from_any_side(graphics, solid_folder, monkeypatch):
    """Straight on at true scale the wall has its area, from its end it is as wide as it is deep."""
    sides = {90.0: 2.0 * WALL_LENGTH, 0.0: WALL_DEPTH}
    for azimuth, width in sides.items():
        asked = Standpoint(azimuth=azimuth, elevation=0.0)
        page = drawn(solid_folder, monkeypatch, frame="0", standpoint=asked, scale=1.0, joints=False)
        wide = (page[44:] < 250).any(axis=-1).sum(axis=1)
        top = int(np.flatnonzero(wide)[0])
        below = top + int(np.flatnonzero(wide[top + 20 :] > 1.1 * wide[top + 20])[0]) + 20  # the base is wider
        assert wide[top + 20] / (below - top) == pytest.approx(width / (3 * WALL_HEIGHT), rel=0.02)


def test_forces_in_space_stand_before_the_stones(graphics, solid_folder, monkeypatch):
    page = drawn(solid_folder, monkeypatch, frame="last", forces="bars")
    body = page[70:-40]
    assert (body[..., 2].astype(int) - body[..., 0] > 60).sum() > 200
    assert near(body, style.STATE_COLOURS["open"]).sum() > 20


def test_in_the_plane_nobody_walks_around(folder):
    code, output = dem("render", folder, "--azimuth", "30")
    assert code == 2
    assert "--azimuth and --elevation are for structures in space" in output


def test_standpoints(folder, solid_folder):
    plane, space = read(folder), read(solid_folder)
    front = view_of(plane.model, plane.frames, Standpoint())
    assert (front.axes.eye == (0.0, 0.0, 1.0)).all()
    assert not front.deep
    eye = view_of(space.model, space.frames, Standpoint("front")).axes.eye
    assert eye == pytest.approx([0.0, 1.0, 0.0])  # it falls towards +y
    assert view_of(space.model, space.frames, Standpoint()).axes.eye[2] > 0.3


def test_a_still_of_its_size(graphics, folder, tmp_path):
    code, output = dem("render", folder, "-o", tmp_path / "a.png", "--size", "640x480", "--forces")
    assert (code, output) == (0, f"{tmp_path / 'a.png'}\n")
    assert [path.name for path in tmp_path.iterdir()] == ["a.png"]
    with Image.open(tmp_path / "a.png") as picture:
        assert picture.size == (640, 480)


@pytest.mark.parametrize("colour", ["stone", "displacement", "rotation"])
@pytest.mark.parametrize("forces", [None, "bars", "arrows"])
@pytest.mark.parametrize("width", [320, 960, 1440])
def test_no_legend_is_cut(folder, colour, forces, width):
    """Four entries beside a colour bar lost half of the first and of the last."""
    results = read(folder)
    frames = render.chosen(results, "last")
    handles = block_colours.legend(results, frames, True, forces)
    _, bar = block_colours.colours(results, frames, colour)
    plan = layout((width, None), 0.6, len(handles), bar is not None)
    with style.canvas() as make:
        figure = Sheet(make, plan, results.summary, handles, bar).figure
        figure.canvas.draw()
        boxes = [text.get_window_extent() for legend in figure.legends for text in legend.get_texts()]
        axes = [axis.get_tightbbox() for axis in figure.axes]
    assert len(boxes) == len(handles)
    for box in boxes + axes:
        assert box.x0 >= 0.0
        assert box.x1 <= plan.width
        assert box.y0 >= 0.0
        assert box.y1 <= plan.below + 1.0
    assert all(box.x1 < axis.x0 for box in boxes for axis in axes)


def test_a_movie_has_all_frames(graphics, folder):
    assert dem("render", folder, "--movie", "gif", "--size", "400", "--fps", "10")[0] == 0
    delays = []
    with Image.open(folder / "render.gif") as film:
        assert film.n_frames == 6
        for k in range(film.n_frames):
            film.seek(k)
            delays.append(film.info["duration"])
            assert film.convert("RGB").getpixel((399, 60)) == (255, 255, 255)
    assert delays == [600, 100, 100, 100, 100, 1400]


def test_mp4_of_a_shaken_wall(graphics, tmp_path):
    imageio_ffmpeg = pytest.importorskip("imageio_ffmpeg")
    folder = write_shaking(tmp_path, 5)
    code, output = dem("render", folder, "-o", tmp_path / "film.mp4", "--size", "401x301", "--colour", "velocity")
    assert code == 0, output
    film = imageio_ffmpeg.read_frames(str(tmp_path / "film.mp4"))
    facts = next(film)
    film.close()
    assert facts["size"] == (400, 300)
    assert facts["fps"] == pytest.approx(12.5)
    assert facts["duration"] == pytest.approx(5.0 + 0.6 + 1.4, abs=0.25)  # as long as it shook, and the ends


def test_no_graphics_libraries(monkeypatch):
    monkeypatch.delenv("VTK_DEFAULT_OPENGL_WINDOW", raising=False)
    monkeypatch.setattr(opengl, "loaded", lambda name: None)
    monkeypatch.setattr(sys, "platform", "linux")
    with pytest.raises(UsageError, match="apt-get install libegl1 libgl1-mesa-dri"):
        opengl.choose_window()


def test_a_library_that_is_missing_is_none():
    assert opengl.loaded("libno-such-thing.so.9") is None


def test_a_renderer_that_dies_is_reported():
    with pytest.raises(OutputError, match="the renderer died"):
        render.in_own_process(os.abort)


def test_who_does_not_want_to_wait_is_not_made_to(monkeypatch):
    def interrupt(connection):
        raise KeyboardInterrupt

    before = set(multiprocessing.active_children())
    monkeypatch.setattr("multiprocessing.connection.Connection.recv", interrupt)
    with pytest.raises(KeyboardInterrupt):
        render.in_own_process(time.sleep, 3600.0)
    assert set(multiprocessing.active_children()) <= before


def test_errors_come_back_from_the_other_process(tmp_path):
    with pytest.raises(UsageError, match="no such folder"):
        render.in_own_process(read, tmp_path / "nowhere")
    with pytest.raises(FileNotFoundError):
        render.in_own_process(os.listdir, tmp_path / "nowhere")


def test_a_fault_of_the_program_is_not_blamed_on_drivers():
    with pytest.raises(RuntimeError, match="ValueError: could not convert") as caught:
        render.in_own_process(float, "x")
    assert any("in _work_alone" in note for note in caught.value.__notes__)


def test_the_reason_is_the_last_that_was_said():
    said = "\x1b[31m2026 ( 0.7s) [ 7F] vtkOSOpenGL:150  WARN| no library of that name\x1b[0m\n\n"
    assert "no library of that name" in render._death(said)
    assert "\x1b" not in render._death(said)


@pytest.mark.parametrize(
    ("arguments", "says"),
    [
        (("--frame", "6"), "the run kept 6 frames, 0 to 5"),
        (("--frame", "1s"), "only time histories have a time"),
        (("--frame", "soon"), "give last, failure, a number from 0 to 5"),
        (("--colour", "velocity"), "only time histories"),
        (("-o", "a.jpg"), "has to end in .png, .gif or .mp4"),
        (("-o", "a.png", "--movie", "gif"), "--movie gif writes .gif"),
        (("--movie", "gif", "--frame", "2"), "--frame is for stills"),
        (("--size", "10x10"), "200 to 8000 pixels"),
    ],
)
def test_wrong_arguments(graphics, folder, arguments, says):
    code, output = dem("render", folder, *arguments)
    assert code == 2
    assert says in output
    assert len(output.splitlines()) <= 4


def test_no_results(tmp_path):
    code, output = dem("render", tmp_path)
    assert (code, output) == (2, f"error: {tmp_path}: holds no results of dem run (no results.h5)\n")


@pytest.mark.parametrize("missing", ["pyvista", "imageio_ffmpeg"])
def test_an_extra_that_is_missing(folder, tmp_path, monkeypatch, missing):
    whether = {"find_spec": lambda name: None if name == missing else object()}
    monkeypatch.setattr(render, "find_spec", whether["find_spec"])
    monkeypatch.setattr(movie, "find_spec", whether["find_spec"])
    code, output = dem("render", folder, "--movie", "mp4", "-o", tmp_path / "a.mp4")
    assert code == 2
    extra = {"pyvista": "viz", "imageio_ffmpeg": "movie"}[missing]
    assert f"pip install '{ROOT}[{extra}]'" in output
    assert len(output.splitlines()) == 1


def test_frames_by_name_number_and_time(folder, tmp_path):
    results = read(folder)
    assert render.chosen(results, "last")[0].step == 500
    assert render.chosen(results, "-2")[0].step == 400
    assert render.chosen(results, "failure")[0].load == pytest.approx(0.64)
    shaken = read(write_shaking(tmp_path, 6))
    assert render.chosen(shaken, "2.1s")[0].time == pytest.approx(2.0)


def test_captions_say_how_many_times_larger(folder):
    results = read(folder)
    frame = results.frames[1]
    assert "displacements drawn 500 times larger" in render.caption(results, frame, 500.0)
    assert "true scale" in render.caption(results, frame, 1.0)
    assert "λ = −0.1" in render.caption(results, frame._replace(load=-0.1), 1.0)


def test_colours_run_from_nothing_to_the_largest(folder):
    results = read(folder)
    frame = results.frames[-1]
    drawn, bar = block_colours.colours(results, [frame], "displacement")
    moved = np.linalg.norm(frame.positions - results.model.centroids, axis=1)
    assert bar.label == "displacement of the block [mm]"
    assert bar.high == pytest.approx(1e3 * moved.max())
    still = ~results.model.fixed & (moved == 0.0)
    assert np.ptp(drawn[0][still], axis=0).max() == 0.0
    assert drawn[0][np.argmax(moved)].sum() < drawn[0][still][0].sum()  # darker
