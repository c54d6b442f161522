"""Draw collapse.gif: the structure from frame to frame, time histories in real time on the moving ground."""

from __future__ import annotations

from collections.abc import Sequence
from pathlib import Path
from typing import Any

import numpy as np

from dem_cli.analysis_kinds import kind_of
from dem_cli.core.records.frames import Frame
from dem_cli.errors import MissingExtra, UsageError
from dem_cli.results.output.paraview.vertices import rest_vertices
from dem_cli.results.output.reader import Results
from dem_cli.results.output.series import HistorySeries
from dem_cli.results.post import frame_measures, style, view_box
from dem_cli.results.post.histories import base_colours
from dem_cli.results.post.playback import milliseconds, playback
from dem_cli.results.post.scene.axonometry import AS_BEST, Standpoint
from dem_cli.results.post.scene.drawing import drawing_of

_LAST_MS = 1200  # the last one stays longer
_DPI = 100
_WHITE = "#ffffff"
_SHADES = 7  # of each pair of colours that meet at a smooth edge
_MOST_LIT = 96  # colours of stone, and of ground
_EDGES = tuple((_WHITE, ink) for ink in (style.INK, style.GREY, style.COLLAPSE, style.STONE_EDGE, style.THRUST))


def draw_animation(results: Results, path: Path, asked: Standpoint = AS_BEST) -> None:
    """Draw one picture per frame. Raises UsageError where the run kept no frames, or Pillow is missing."""
    if not len(results.frames):
        raise UsageError("the results hold no frames (output.frames = 0), so there is nothing to animate")
    movie = playback(results)
    pictures = _pictures(results, movie.frames, asked)
    times = [*milliseconds(movie.stays[:-1]), _LAST_MS]
    with path.open("wb") as file:
        pictures[0].save(
            file, "GIF", save_all=True, append_images=pictures[1:], duration=times, loop=0, optimize=True, disposal=1
        )


def _pictures(results: Results, frames: Sequence[Frame], asked: Standpoint) -> list[Any]:
    """Draw frames as images that share one palette."""
    with style.canvas() as make:
        try:
            from PIL import Image
        except ImportError:
            raise MissingExtra("an animation needs Pillow", "plot") from None
        scene = _Scene(results, frames, make, asked)
        palette = Image.new("P", (1, 1))
        palette.putpalette(_palette(scene.drawing.lights))
        pictures = []
        for frame in frames:
            scene.show(frame)
            image = Image.frombuffer("RGBA", *scene.pixels()).convert("RGB")
            pictures.append(image.quantize(palette=palette, dither=Image.Dither.NONE))
    return pictures


def _palette(lights: Sequence[float]) -> list[int]:
    """Return red, green and blue of every colour of the pictures: flat areas and the shades of their edges.

    lights: by which blocks are lighter or darker than their stone.
    """
    from matplotlib.colors import to_rgb

    def between(a: np.ndarray, b: np.ndarray, count: int) -> np.ndarray:
        return a + np.linspace(0.0, 1.0, count)[:, np.newaxis] * (b - a)

    shades = [between(np.array(to_rgb(a)), np.array(to_rgb(b)), _SHADES) for a, b in _EDGES]
    count = max(2, min(_SHADES, _MOST_LIT // len(lights)))
    for stone in (style.STONE, style.GROUND):
        lit = [np.clip(light * np.array(to_rgb(stone)), 0.0, 1.0) for light in lights]
        shades += [between(colour, np.array(to_rgb(style.STONE_EDGE)), count) for colour in lit]
    return np.rint(255.0 * np.concatenate(shades)).astype(int).ravel().tolist()


class _Scene:
    """Animated figure: the structure above, the acceleration of its base below."""

    def __init__(self, results: Results, frames: Sequence[Frame], make: Any, asked: Standpoint):
        model, self.results = results.model, results
        self.model = model
        self.scale = min(frame_measures.visible_scale(model, frame) for frame in frames)
        self.drawing = drawing_of(model, max(frames, key=lambda frame: frame.displacement), asked)
        self.carried = view_box.carried(results, self.scale)
        corners = [self._corners(frame) for frame in frames]
        low, high = self.drawing.window(corners, *view_box.window(model, corners))
        series = results.series
        self.strip = series is not None and bool((series.base[:, 0] != 0.0).any())
        width, height = _size(high - low)
        self.figure = make(figsize=(width, height + (1.3 if self.strip else 0.0) + 0.4), dpi=_DPI)
        rows = self.figure.subplots(1 + self.strip, 1, squeeze=False, height_ratios=[height, 1.1][: 1 + self.strip])
        self.axis = rows[0, 0]
        self._draw_structure(low, high)
        if self.strip and series is not None:
            self._draw_strip(rows[1, 0], series)
        style.headline(self.figure, results.summary)
        self.show(frames[0])
        for _ in range(2):  # the layout finds itself, and stays
            self.figure.canvas.draw()
        self.figure.set_layout_engine("none")

    def _corners(self, frame: Frame) -> np.ndarray:
        """Return the corners as drawn, carried along by the ground [m], (n_vertices, d)."""
        moved = view_box.ground(self.results.series, frame) if self.carried else 0.0
        return view_box.corners(self.model, frame, self.scale, moved)

    def _draw_structure(self, low: np.ndarray, high: np.ndarray) -> None:
        self.place = self.drawing.draw_blocks(self.axis, low, high)
        self.axis.set_aspect("equal")
        self.axis.set_xlim(low[0], high[0])
        self.axis.set_ylim(low[1], high[1])
        self.axis.axis("off")
        self.drawing.finish(self.axis)
        if self.carried:  # a place in space that stays, so that one sees the ground move
            middle = self.drawing.flat(rest_vertices(self.model))[:, 0].mean()
            self.axis.plot(middle, low[1], "^", ms=9, color=style.INK, clip_on=False)

    def _draw_strip(self, axis: Any, series: HistorySeries) -> None:
        moved = [k for k, path in enumerate(series.base[:, 0].T) if path.any()]
        for k in moved:
            colour = style.GREY if len(moved) == 1 else base_colours(series)[k]
            axis.plot(series.time, series.base[:, 0, k], lw=0.8, color=colour, label="xyz"[k])
        if len(moved) > 1:
            axis.legend(loc="center left", bbox_to_anchor=(1.0, 0.5), fontsize=8, handlelength=1.0, borderpad=0.1)
        axis.set_xlim(0.0, series.time[-1] or 1.0)
        axis.set_ylabel("base\n[m/s2]")
        axis.set_xlabel("time [s]")
        self.cursor = axis.axvline(0.0, color=style.COLLAPSE, lw=1.4)

    def show(self, frame: Frame) -> None:
        """Move the blocks to their places in a frame."""
        self.place(self._corners(frame))
        timed = kind_of(self.results.kind).timed
        text = f"{frame.time:.2f} s" if timed else f"{frame.stage}: λ = {frame.load:.3f}"
        drawn = "" if self.scale == 1.0 else f", displacements × {self.scale:,.0f}"
        self.axis.set_title(text + drawn, fontsize=10, fontweight="normal")
        if self.strip:
            self.cursor.set_xdata([frame.time, frame.time])

    def pixels(self) -> tuple[tuple[int, int], bytes]:
        """Return size and RGBA bytes of the picture."""
        self.figure.canvas.draw()
        buffer = np.asarray(self.figure.canvas.buffer_rgba())
        return (buffer.shape[1], buffer.shape[0]), buffer.tobytes()


def _size(extent: np.ndarray) -> tuple[float, float]:
    """Return width and height of the structure's part of the picture [inches]."""
    width = float(np.clip(4.4 * extent[0] / extent[1], 4.2, 6.4))
    return width, float(np.clip(width * extent[1] / extent[0], 1.6, 4.6))
