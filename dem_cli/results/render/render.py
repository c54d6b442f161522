"""Render render.png, render.gif, render.mp4: the structure in a stone look, in a separate process.

A graphics driver that fails takes its process along: `render_apart` survives that and says what happened.
"""

from __future__ import annotations

import multiprocessing
import os
import re
import signal
import tempfile
import traceback
from collections.abc import Callable
from dataclasses import dataclass
from importlib.util import find_spec
from multiprocessing.connection import Connection
from pathlib import Path

import numpy as np

from dem_cli.analysis_kinds import kind_of
from dem_cli.core.model.model import Model
from dem_cli.core.records.frames import Frame
from dem_cli.errors import DemError, MissingExtra, OutputError, UsageError
from dem_cli.results.output.reader import Frames, Results, read
from dem_cli.results.post import collapse, frame_measures, style, view_box
from dem_cli.results.post.playback import SHORTEST, Playback, playback
from dem_cli.results.post.scene.axonometry import AS_BEST, Standpoint
from dem_cli.results.render import block_colours, movie
from dem_cli.results.render.solids import lifted
from dem_cli.results.render.view import view_of

STILL_WIDTH, MOVIE_WIDTH = 1440, 960  # pixels
_AROUND = 0.015  # of the size of what is seen: empty space on all sides


@dataclass(frozen=True)
class RenderOptions:
    """Options of a rendered picture."""

    frame: str = "last"  # of a still: "last", "failure", a number, or a time such as "2.5s"
    standpoint: Standpoint = AS_BEST
    scale: float | None = None  # of displacements; None: as they are where they can be seen
    colour: str = "stone"
    joints: bool = True  # coloured by state
    forces: str | None = None  # "bars", "arrows"
    size: tuple[int, int | None] | None = None  # of the whole picture [pixels]
    fps: float | None = None  # of a movie; None: time histories as fast as they were, others 12.5


def render_apart(folder: Path, path: Path, look: RenderOptions) -> None:
    """Render the results in `folder` into a file, in a separate process: a still (.png) or a movie (.gif, .mp4).

    Raises UsageError where packages, graphics libraries or frames are missing, OutputError where the renderer died.
    """
    for name in ("pyvista", "matplotlib", "PIL"):
        if find_spec(name) is None:
            raise MissingExtra("rendering needs pyvista", "viz")
    movie.check(path.suffix[1:])
    try:
        in_own_process(render, folder, path, look)
    finally:
        movie.unfinished(path).unlink(missing_ok=True)


def in_own_process(work: Callable[..., object], *arguments: object) -> None:
    """Run `work` in a separate process. Raises its errors, and OutputError where graphics kill the process."""
    context = multiprocessing.get_context("spawn")
    receiver, sender = context.Pipe(duplex=False)
    with tempfile.NamedTemporaryFile() as log, receiver:
        child = context.Process(target=_work_alone, args=(sender, log.name, work, arguments), daemon=True)
        child.start()
        sender.close()
        try:
            error = receiver.recv()
        except EOFError:
            child.join()
            said = Path(log.name).read_text(encoding="utf-8", errors="replace")
            raise OutputError(_death(said)) from None
        finally:  # also where the user does not want to wait
            child.kill()
            child.join()
    if error is not None:
        raise error


def _work_alone(sender: Connection, log: str, work: Callable[..., object], arguments: tuple[object, ...]) -> None:
    """Run `work` in the child process with stderr in a file, and send its error, or None, to the parent."""
    signal.signal(signal.SIGINT, signal.SIG_IGN)  # the parent ends this process
    os.dup2(os.open(log, os.O_WRONLY | os.O_APPEND), 2)
    error: Exception | None = None
    try:
        work(*arguments)
    except (DemError, OSError, MemoryError) as found:
        error = found
    except ImportError:  # of a graphics library
        raise
    except Exception as found:  # a fault of the program, for which no driver is to blame
        error = RuntimeError(f"{type(found).__name__}: {found}")
        error.add_note(traceback.format_exc())
    sender.send(error)


def _death(said: str) -> str:
    """Create one message from the output of a renderer that died."""
    lines = [re.sub(r"\x1b\[[0-9;]*m", "", line).split("| ")[-1].strip() for line in said.splitlines()]
    reason = next((line for line in reversed(lines) if line), "it said nothing")
    return f"the renderer died ({reason}); drivers may be to blame: `dem plot` draws without them"


def render(folder: Path, path: Path, look: RenderOptions) -> None:
    """Render the results in this process (see `render_apart`)."""
    from dem_cli.results.render import opengl

    results = read(folder)
    if path.suffix == ".png":
        frames, stays = chosen(results, look.frame), [0.0]
    else:
        frames, stays = all_frames(results, look.fps)
    opengl.choose_window()
    pages = draw(results, frames, look, MOVIE_WIDTH if len(frames) > 1 else STILL_WIDTH)
    if path.suffix == ".png":
        _write_png(pages[0], path)
    else:
        movie.write(pages, path, stays)


def _write_png(page: np.ndarray, path: Path) -> None:
    from PIL import Image

    part = movie.unfinished(path)
    Image.fromarray(page).save(part, "PNG", optimize=True)
    part.replace(path)


def draw(results: Results, frames: list[Frame], look: RenderOptions, width: int) -> list[np.ndarray]:
    """Draw all pages, as (height, width, 3) bytes."""
    from dem_cli.results.render.scene import Scene, camera
    from dem_cli.results.render.sheet import Sheet, layout

    model = results.model
    view = view_of(model, frames, look.standpoint)
    scale = look.scale or min(frame_measures.visible_scale(model, frame) for frame in frames)
    moves = [_moved(results, frame, scale) for frame in frames]
    corners = [view_box.corners(model, f, scale, m) for f, m in zip(frames, moves)]
    eye = camera(view.axes, _seen(model, corners), view.before)
    colours, bar = block_colours.colours(results, frames, look.colour)
    handles = block_colours.legend(results, frames, look.joints, look.forces)
    handles += block_colours.legend_of_links(frames)
    plan = layout(look.size or (width, None), eye.height / eye.width, len(handles), bar is not None)
    with style.canvas() as make:
        sheet = Sheet(make, plan, results.summary, handles, bar)
        scene = Scene(model, eye, plan.width, plan.picture, plan.points, deep=view.deep)
        try:
            pages = []
            for i, (frame, moved) in enumerate(zip(frames, moves)):
                shown = frame_measures.scaled(model, frame, scale)
                picture = scene.picture(shown, scale, moved, look, None if colours is None else colours[i])
                pages.append(sheet.page(picture, caption(results, frame, scale)))
        finally:
            scene.close()
    return pages


def _seen(model: Model, places: list[np.ndarray]) -> np.ndarray:
    """Return the corners of the blocks in space, clipped to the limits of the picture [m], (n, 3)."""
    low, high = view_box.window(model, places, _AROUND)
    half = 0.5 * model.thickness[model.vertex_blocks]
    inside = [np.clip(corners, low, high) for corners in places]
    return np.concatenate([lifted(corners, side * half) for corners in inside for side in (-1.0, 1.0)])


def _moved(results: Results, frame: Frame, scale: float) -> np.ndarray:
    """Return the ground displacement that carries everything in this frame [m], (d,)."""
    if view_box.carried(results, scale):
        return view_box.ground(results.series, frame)
    return np.zeros(results.model.dimension)


def all_frames(results: Results, fps: float | None = None) -> Playback:
    """Choose the frames of a movie and their durations [s]. Raises UsageError where none can be made."""
    if kind_of(results.kind).shapes:
        raise UsageError(f"the frames of {results.kind!r} do not follow each other: no movie, but --frame N draws each")
    if len(results.frames) < 2:
        raise UsageError("a movie needs frames, and the run kept fewer than two (output.frames)")
    return playback(results, None if fps is None else max(1.0 / fps, SHORTEST))


def chosen(results: Results, text: str) -> list[Frame]:
    """Return the one frame that `--frame` selects."""
    frames = results.frames
    if not len(frames):
        raise UsageError("the results hold no frames (output.frames = 0), so there is nothing to render")
    return [frames[frame_number(frames, results, text)]]


def frame_number(frames: Frames, results: Results, text: str) -> int:
    """Return the number of the frame that `--frame` selects. Raises UsageError where there is none."""
    if text == "last":
        return len(frames) - 1
    if text == "failure":
        found = collapse.failure_frame(results)
        if found is None:
            raise UsageError("--frame failure: the results have no failure load")
        return found
    if re.fullmatch(r"-?\d+", text):
        number = int(text)
        if not -len(frames) <= number < len(frames):
            raise UsageError(f"--frame {text}: the run kept {len(frames)} frames, 0 to {len(frames) - 1}")
        return number % len(frames)
    if match := re.fullmatch(r"(\d*\.?\d+(?:[eE][-+]?\d+)?) ?s", text):
        times = np.array([frame.time for frame in frames])
        if not times.any():
            raise UsageError(f"--frame {text}: only time histories have a time")
        return int(np.abs(times - float(match[1])).argmin())
    last = len(frames) - 1
    raise UsageError(f"--frame {text}: give last, failure, a number from 0 to {last}, or a time such as 2.5s")


def caption(results: Results, frame: Frame, scale: float) -> str:
    """Return the caption of a picture with the scale of displacements."""
    if results.kind == "modes" and frame.stage == "mode":
        frequency = results.summary["frequencies"][frame.step - 1]
        return f"mode {frame.step}: {frequency:.4g} Hz · of any size"
    if results.kind == "limit":
        return f"{frame.stage} mechanism: λ = {frame.load:.4g} · of any size: rigid blocks do not move before failure"
    factor, unit = style.length_unit(frame.displacement)
    instant = f"{frame.time:.2f} s" if kind_of(results.kind).timed else f"{frame.stage}: λ = {frame.load:.4g}"
    times = f"{float(format(scale, '.4g')):,.10g}"
    drawn = "true scale" if scale == 1.0 else f"displacements drawn {times} times larger"
    instant = instant.replace("-", "−")
    return f"{instant} · moved up to {factor * frame.displacement:.3g} {unit} · {drawn}"
