"""Draw headline, caption, legend and colour bar around a rendered picture."""

from __future__ import annotations

from collections.abc import Mapping, Sequence
from typing import Any, NamedTuple

import numpy as np

from dem_cli.results.post import style

WIDTH = 8.0  # inches: text has the size that it would have on a sheet of this width
_HEADER, _LEGEND, _BAR = 0.58, 0.34, 0.56  # inches
_ROW = 0.16  # inches: an entry of a legend that stands beside a colour bar, one below the other
_LOWEST, _HIGHEST = 0.3, 0.85  # of the width: the picture without what stands around it


class ColourBar(NamedTuple):
    """Colour bar with label and range."""

    label: str  # with its unit
    low: float
    high: float
    colours: Any  # colour map


class SheetLayout(NamedTuple):
    """Layout of a sheet: sizes in pixels."""

    width: int
    height: int
    picture: int  # height of the rendered part
    below: int  # height of what is below it
    points: float  # pixels of a typographic point


def layout(size: tuple[int, int | None], aspect: float, entries: int, bar: bool) -> SheetLayout:
    """Compute the layout around a picture `aspect` times as high as wide; all sizes even, as movies need it.

    size: of the whole [pixels]; height None: as the picture asks for. entries: of the legend.
    """
    width = size[0] - size[0] % 2
    inch = width / WIDTH
    below = round(inch * (max(_BAR, _ROW * entries + 0.08) if bar else _LEGEND if entries else 0.08))
    around = round(inch * _HEADER) + below
    height = size[1] or around + round(width * float(np.clip(aspect, _LOWEST, _HIGHEST)))
    height -= height % 2
    return SheetLayout(width, height, max(2, height - around), below, inch / 72.0)


class Sheet:
    """Surroundings common to every picture of a series; use inside `style.canvas()`, whose `make` is handed in."""

    def __init__(
        self,
        make: Any,
        plan: SheetLayout,
        summary: Mapping[str, Any],
        handles: Sequence[Any] = (),
        bar: ColourBar | None = None,
    ):
        dpi = plan.width / WIDTH
        self.figure = make(figsize=(WIDTH, plan.height / dpi), dpi=dpi)
        self.figure.set_layout_engine("none")
        self.below, self._blank = plan.below, None
        style.headline(self.figure, summary)
        self.figure.texts[-1].set_y(1.0 - 0.07 * dpi / plan.height)
        self.caption = self.figure.text(
            0.01, 1.0 - 0.31 * dpi / plan.height, "", ha="left", va="top", fontsize=9.5, color=style.INK, animated=True
        )
        if bar is not None:
            self._draw_bar(bar, plan)
        if handles:
            middle = 0.5 * plan.below / plan.height
            self.figure.legend(
                handles=handles, loc="center left", bbox_to_anchor=(0.0, middle), ncols=1 if bar else 5, fontsize=9,
                handlelength=1.6, columnspacing=1.6, labelspacing=0.25, borderpad=0.2,
            )  # fmt: skip

    def _draw_bar(self, bar: ColourBar, plan: SheetLayout) -> None:
        from matplotlib.cm import ScalarMappable
        from matplotlib.colors import Normalize

        inch = plan.width / WIDTH / plan.height
        axis = self.figure.add_axes((0.5, 0.39 * inch, 0.47, 0.11 * inch))
        scale = ScalarMappable(Normalize(bar.low, bar.high), bar.colours)
        drawn = self.figure.colorbar(scale, axis, orientation="horizontal")
        drawn.outline.set_visible(False)
        drawn.ax.tick_params(labelsize=8, length=2, pad=1)
        drawn.ax.locator_params(nbins=6)
        drawn.set_label(bar.label, fontsize=9, labelpad=0)

    def page(self, picture: np.ndarray, caption: str) -> np.ndarray:
        """Draw the whole sheet with a picture in it, (height, width, 3) bytes."""
        canvas = self.figure.canvas
        if self._blank is None:  # all that stays is drawn once
            canvas.draw()
            self._blank = canvas.copy_from_bbox(self.figure.bbox)
        canvas.restore_region(self._blank)
        self.caption.set_text(caption)
        self.figure.draw_artist(self.caption)
        page = np.asarray(canvas.buffer_rgba())[..., :3].copy()
        top = len(page) - self.below - len(picture)
        page[top : top + len(picture)] = picture
        return page
