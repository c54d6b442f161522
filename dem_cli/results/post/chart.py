"""Layout of charts: panels, readable units, limits, colours of a family of curves, place of the legend."""

from __future__ import annotations

import textwrap
from collections.abc import Sequence
from dataclasses import dataclass
from pathlib import Path
from typing import Any

import numpy as np

from dem_cli.errors import UsageError
from dem_cli.results.post import style
from dem_cli.results.post.labels import Quantity

COLOURS = ("#1f5fa8", "#e08214", "#2a8c5b", "#8250a8", "#c51b7d", "#5aa0d8", "#a6761d", "#7c7c86")
DASHES: tuple[Any, ...] = ("-", (0, (5, 2)), (0, (1.2, 1.6)), (0, (6, 2, 1.2, 2)))
MARKERS = "osD^vPX"
CHART_FORMATS = (".png", ".svg", ".pdf")
SIZE = (7.4, 4.6)  # inches
MOST_NAMES = 8  # in a legend: more numbers become a colour bar
_PREFIXES = ((1e6, "M"), (1e3, "k"), (1.0, ""), (1e-3, "m"), (1e-6, "µ"))
_LONGEST_TITLE = 11.0  # letters per inch


@dataclass(frozen=True)
class ChartOptions:
    """Options of a chart: size, logarithmic axes, limits."""

    size: tuple[int, int | None] | None = None  # pixels
    log: frozenset[str] = frozenset()  # axes: "x", "y"
    x_limits: tuple[float, float] | None = None
    y_limits: tuple[float, float] | None = None

    @property
    def inches(self) -> tuple[float, float]:
        """Width and height of the chart [inches]."""
        if self.size is None:
            return SIZE
        width, height = self.size
        return width / style.DPI, (height or width * SIZE[1] / SIZE[0]) / style.DPI


class FamilyColours:
    """Colours for the members of a family: by number along a scale, or one after the other."""

    def __init__(self, values: Sequence[Any]):
        from matplotlib import colormaps
        from matplotlib.colors import ListedColormap

        self.values = list(dict.fromkeys(values))
        numbers = [v for v in self.values if isinstance(v, (int, float)) and not isinstance(v, bool)]
        self.numeric = len(numbers) == len(self.values) and len(numbers) > 1
        self.bar = self.numeric and len(self.values) > MOST_NAMES
        if self.numeric:
            self.values.sort()
        scale = ListedColormap(colormaps["viridis"](np.linspace(0.0, 0.82, 256)))
        self.scale, self.low, self.high = scale, min(numbers, default=0.0), max(numbers, default=1.0)

    def colour(self, value: Any) -> Any:
        """Return the colour of a member."""
        if self.bar:
            return self.scale((value - self.low) / (self.high - self.low))
        i = self.values.index(value)
        if self.numeric:
            return self.scale(i / (len(self.values) - 1))
        return COLOURS[i % len(COLOURS)]


def draw_bar(figure: Any, axes: Any, keys: FamilyColours, label: str) -> None:
    """Draw the colour bar beside all panels."""
    from matplotlib.cm import ScalarMappable
    from matplotlib.colors import Normalize

    drawn = figure.colorbar(ScalarMappable(Normalize(keys.low, keys.high), keys.scale), ax=axes, pad=0.02, aspect=30)
    drawn.set_label(label)
    drawn.outline.set_visible(False)


def wrapped(text: str, width: int = 22) -> str:
    """Wrap a heading of a legend into short lines."""
    return "\n".join(textwrap.wrap(text, width)) or text


def fitted(quantity: Quantity, values: Sequence[np.ndarray]) -> tuple[float, str]:
    """Return a factor that makes values readable, and the matching label."""
    if quantity.unit not in ("m", "J", "N"):
        return 1.0, quantity.label()
    largest = max((float(np.abs(v[np.isfinite(v)]).max(initial=0.0)) for v in values), default=0.0)
    if quantity.unit == "m":
        factor, unit = style.length_unit(largest)
    else:
        power, letter = next((pair for pair in _PREFIXES if largest >= pair[0]), _PREFIXES[-1])
        factor, unit = 1.0 / power, letter + quantity.unit
    return factor, quantity.label(unit)


def dress(axis: Any, options: ChartOptions) -> None:
    """Apply limits and logarithmic scales. Raises UsageError where an axis cannot be logarithmic."""
    for name, limits in (("x", options.x_limits), ("y", options.y_limits)):
        if name in options.log:
            if getattr(axis, f"get_{name}lim")()[1] <= 0.0:
                raise UsageError(f"--log {name}: there is nothing positive to draw")
            getattr(axis, f"set_{name}scale")("log", nonpositive="mask")
            getattr(axis, f"{name}axis").set_major_formatter("{x:g}")
        if limits is not None:
            getattr(axis, f"set_{name}lim")(*limits)


def title(figure: Any, text: str) -> None:
    """Draw the title on one line, cut where it would leave the picture."""
    width = figure.get_figwidth()
    most = int(_LONGEST_TITLE * width * 1.25)
    text = text if len(text) <= most else text[: most - 1] + "…"
    size = min(12.0, 12.0 * _LONGEST_TITLE * width / max(1, len(text)))
    figure.suptitle(text, x=0.01, ha="left", fontsize=size, fontweight="bold")


def check_format(path: Path) -> None:
    """Raise UsageError where matplotlib does not know the file format."""
    if path.suffix.lower() not in CHART_FORMATS:
        raise UsageError(
            f"-o {path}: the name of a chart has to end in {', '.join(CHART_FORMATS[:-1])} or {CHART_FORMATS[-1]}"
        )
