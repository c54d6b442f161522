"""Drawing of structures in space: axonometric view of lit faces with crisp edges and visible joints."""

from __future__ import annotations

from collections.abc import Callable, Sequence
from typing import Any

import numpy as np

from dem_cli.core.model.model import Model
from dem_cli.core.records.frames import STATES, Frame
from dem_cli.results.output.paraview.vertices import rest_vertices
from dem_cli.results.post import style
from dem_cli.results.post.scene.axonometry import Axonometry, looks_right
from dem_cli.results.post.scene.hidden_surfaces import NOTHING, SeenSurface, Window, seen_surface, window_of
from dem_cli.results.post.scene.joint_strokes import visible_strokes
from dem_cli.results.post.scene.link_lines import draw_lines
from dem_cli.results.post.scene.plane_drawing import joint_width, state_colour

_FINEST = 1800  # pixels along the longer side of a picture
_LIGHT = (0.14, 0.20, 0.06)  # to where the wide side looks, upwards, to the reader: how it changes the colour of a face
_AMBIENT = 0.84
_SAME_PLANE = 1e-4  # of the size of the structure: faces of one block that close to one plane are one
_PIECE = 4.0  # pixels of a stroke that are seen or hidden as one
_DEEP = 6.0  # pixels: by so much something must be nearer to hide a stroke
_MARGIN = 0.02  # of the longer side: empty space around an animation
_TRIAD = 0.055  # of the longer side: the arrows that show x, y and z


class SpaceDrawing:
    """Drawing of a structure in space."""

    legend = tuple(name for name in STATES if name != "sticking")  # edges of the stones show closed joints
    force_width = 0.6  # all forces are drawn, those behind too
    lights = tuple(np.linspace(0.58, 1.06, 16).tolist())  # those between them are close enough to one

    def __init__(self, model: Model, view: Axonometry):
        self.model, self.view = model, view
        self.starts, self.corners = model.topology.face_starts, model.topology.face_corners
        self.owners = model.part_blocks[model.topology.face_parts]
        self.lit_from = looks_right(model, view)
        self.seen: SeenSurface | None = None

    def flat(self, points: np.ndarray) -> np.ndarray:
        """Project points (n, 3) to the picture plane [m], (n, 2)."""
        return self.view.flat(points)

    def window(self, corners: Sequence[np.ndarray], low: np.ndarray, high: np.ndarray) -> tuple[np.ndarray, np.ndarray]:
        """Return the limits of the picture that show all corners (n, 3) as far as they are in a box in space."""
        seen = np.concatenate([self.flat(np.clip(places, low, high)) for places in corners])
        left, right = seen.min(axis=0), seen.max(axis=0)
        margin = _MARGIN * float((right - left).max())
        return left - margin, right + margin

    def draw_blocks(self, axis: Any, low: np.ndarray, high: np.ndarray) -> Callable[[np.ndarray], None]:
        """Draw the blocks, lit, fixed ones as ground; returns a function that moves their corners (n_vertices, 3)."""
        window = window_of(low, high, _FINEST)
        right, top = window.low + window.pixel * np.array(window.shape[::-1])
        blank = np.full((*window.shape, 3), 255, np.uint8)
        picture = axis.imshow(
            blank, origin="lower", extent=(low[0], right, low[1], top), interpolation="antialiased", zorder=1
        )

        def place(corners: np.ndarray) -> None:
            picture.set_data(self._picture(corners, window))

        return place

    def _picture(self, corners: np.ndarray, window: Window) -> np.ndarray:
        """Return red, green and blue of every pixel, rows from below."""
        from matplotlib.colors import to_rgb

        places = self.view.placed(corners)
        self.seen = seen = seen_surface(places, self.starts, self.corners, window)
        normals, sheets = self._sheets(places)
        stone = np.where(self.model.fixed[self.owners, np.newaxis], to_rgb(style.GROUND), to_rgb(style.STONE))
        light = np.array(_LIGHT) * (self.lit_from, 1.0, 1.0)
        lit = np.clip(stone * (_AMBIENT + normals @ light)[:, np.newaxis], 0.0, 1.0)
        colours = np.rint(255.0 * np.concatenate([lit, [(1.0, 1.0, 1.0)]])).astype(np.uint8)  # the last one: nothing
        picture = colours[seen.faces]
        picture[_edges(np.append(sheets, NOTHING)[seen.faces])] = np.rint(255.0 * np.array(to_rgb(style.STONE_EDGE)))
        return picture

    def _sheets(self, places: np.ndarray) -> tuple[np.ndarray, np.ndarray]:
        """Compute unit normals of all faces in the picture, (n_faces, 3), and the common planes of faces of one
        block.
        """
        at = places[self.corners]
        first = at[self.starts[:-1]]
        arms = at - np.repeat(first, np.diff(self.starts), axis=0)
        after = np.roll(arms, -1, axis=0)  # the last arm of a ring meets one of length zero
        after[self.starts[1:] - 1] = 0.0
        normals = np.add.reduceat(np.cross(arms, after), self.starts[:-1], axis=0)
        normals /= np.maximum(np.linalg.norm(normals, axis=1, keepdims=True), np.finfo(float).tiny)
        size = float(np.ptp(places, axis=0).max())
        offsets = (normals * first).sum(axis=1) / size
        keys = np.rint(np.column_stack([self.owners * _SAME_PLANE, normals, offsets]) / _SAME_PLANE).astype(np.int64)
        return normals, np.unique(keys, axis=0, return_inverse=True)[1].ravel()

    def draw_supports(self, axis: Any, colour: str) -> None:
        """Draw hatches over the visible parts of fixed blocks."""
        if self.seen is None or not self.model.fixed.any():
            return
        fixed = np.append(self.model.fixed[self.owners], False)
        mask = (self.seen.faces != NOTHING) & fixed[self.seen.faces]
        x, y = _middles(self.seen.window)
        with _hatched(colour):
            axis.contourf(x, y, mask, levels=[0.5, 1.5], colors="none", hatches=["////"], zorder=1.5)

    def draw_rest(self, axis: Any, low: np.ndarray, high: np.ndarray) -> None:
        """Draw the initial outline of the structure."""
        free = ~self.model.fixed[self.owners]
        if not free.any():
            return
        window = window_of(low, high, _FINEST // 3)
        places = self.view.placed(rest_vertices(self.model))
        seen = seen_surface(places, self.starts, self.corners, window).faces
        shown = (seen != NOTHING) & np.append(free, False)[seen]
        x, y = _middles(window)
        axis.contour(x, y, shown, levels=[0.5], colors=style.REST, linewidths=0.9, linestyles=[(0, (3, 2))], zorder=2)

    def draw_joints(self, axis: Any, frame: Frame, hairline: float) -> None:
        """Colour each corner of a joint by its contact point, as far as it is visible; closed joints are edges."""
        from matplotlib.collections import LineCollection

        contacts = frame.contacts
        starts, ends, points = visible_strokes(contacts)
        if self.seen is None or not len(points):
            return
        pixel = self.seen.window.pixel
        ends_shown = [self.view.placed(side) for side in (starts, ends)]
        lengths = np.linalg.norm(ends_shown[1][:, :2] - ends_shown[0][:, :2], axis=1)
        pieces = np.maximum(1, np.ceil(lengths / (_PIECE * pixel)).astype(int))
        owner = np.repeat(np.arange(len(pieces)), pieces)
        share = np.arange(len(owner)) - np.repeat(np.cumsum(pieces) - pieces, pieces)
        a, b = (((share + k) / pieces[owner])[:, np.newaxis] for k in (0.0, 1.0))
        along = ends_shown[1][owner] - ends_shown[0][owner]
        begin = ends_shown[0][owner]
        seen = self.seen.shown(begin + 0.5 * (a + b) * along, _DEEP * pixel)
        lines = np.stack([(begin + a * along)[seen, :2], (begin + b * along)[seen, :2]], axis=1)
        colours = [state_colour(int(contacts.state[i]), contacts.gap[i] < hairline) for i in points[owner[seen]]]
        width = joint_width(self.model)
        axis.add_collection(LineCollection(list(lines), colors=colours, linewidths=width, capstyle="butt", zorder=3))

    def draw_links(self, axis: Any, frame: Frame) -> None:
        """Draw ties and bars over all blocks: lines as dark as their force."""
        draw_lines(axis, frame, self.flat)

    def finish(self, axis: Any) -> None:
        """Draw arrows along x, y and z, in the corner from which the foot of the structure recedes."""
        (left, right), (low, high) = axis.get_xlim(), axis.get_ylim()
        length = _TRIAD * max(right - left, high - low)
        at = np.array([left + 1.5 * length if self.lit_from < 0.0 else right - 1.5 * length, low + 1.5 * length])
        for name, direction in zip("xyz", np.eye(3)):
            tip = at + length * self.view.flat(direction[np.newaxis])[0]
            arrow = {"arrowstyle": "-|>", "color": style.GREY, "lw": 0.9, "shrinkA": 0, "shrinkB": 0}
            axis.annotate("", tip, at, arrowprops=arrow, zorder=5, annotation_clip=False)
            axis.text(*(at + 1.35 * (tip - at)), name, color=style.GREY, fontsize=8, ha="center", va="center", zorder=5)


def _middles(window: Window) -> list[np.ndarray]:
    """Return the middles of the pixels of a window, along and upwards [m]."""
    rows, columns = window.shape
    return [window.low[k] + window.pixel * (np.arange(n) + 0.5) for k, n in enumerate((columns, rows))]


def _hatched(colour: str) -> Any:
    """Set the colour of hatches, since those of contours take no other."""
    import matplotlib

    return matplotlib.rc_context({"hatch.color": colour, "hatch.linewidth": 0.6})


def _edges(sheets: np.ndarray) -> np.ndarray:
    """Find the pixels at which one face ends and another begins, (rows, columns) bool."""
    found = np.zeros(sheets.shape, bool)
    differs = sheets[1:] != sheets[:-1]
    found[1:] |= differs
    found[:-1] |= differs
    differs = sheets[:, 1:] != sheets[:, :-1]
    found[:, 1:] |= differs
    found[:, :-1] |= differs
    return found & (sheets != NOTHING)
