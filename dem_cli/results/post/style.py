"""Plot style of all pictures: distinguishable colours, matplotlib without a display."""

from __future__ import annotations

import warnings
from collections.abc import Callable, Iterator, Mapping
from contextlib import contextmanager
from pathlib import Path
from typing import Any

from dem_cli.errors import MissingExtra
from dem_cli.results.output.ending import ending_words

INK, GREY, FAINT = "#26262b", "#7c7c86", "#d5d5da"
STONE, STONE_EDGE, GROUND, REST = "#efe7d8", "#6d6558", "#c9c4ba", "#b9b9c2"
STATE_COLOURS = {"open": "#c51b7d", "sticking": "#9aa3ad", "sliding": "#e08214"}
STAGE_COLOURS = {"gravity": "#7c7c86", "loading": "#1f5fa8", "settlement": "#2a8c5b", "collapse": "#c0392b"}
THRUST, FAILURE, LIMIT, REFERENCE = "#1f5fa8", "#26262b", "#2a8c5b", "#8250a8"
COLLAPSE, SYSTEM = "#c0392b", "#d9730d"
STEEL = "#1d6f5f"  # ties and bars
DPI = 160
# Ratio of the ends of a logarithmic axis, along x and y, up to which it has numbers between powers of ten as well.
_SHORT, _SHORT_UP = 30.0, 3000.0
_METADATA: Any = {  # nothing that differs from day to day
    ".png": {"Software": None}, ".svg": {"Date": None}, ".pdf": {"CreationDate": None}
}  # fmt: skip

_STYLE: Any = {
    "font.size": 10,
    "axes.titlesize": 11,
    "axes.titleweight": "bold",
    "axes.titlelocation": "left",
    "axes.edgecolor": GREY,
    "axes.labelcolor": INK,
    "axes.spines.top": False,
    "axes.spines.right": False,
    "axes.axisbelow": True,
    "axes.grid": True,
    "grid.color": "#ececef",
    "text.color": INK,
    "xtick.color": GREY,
    "ytick.color": GREY,
    "xtick.labelcolor": INK,
    "ytick.labelcolor": INK,
    "legend.frameon": False,
    "lines.linewidth": 1.8,
    "lines.solid_capstyle": "round",
    "figure.facecolor": "white",
    "savefig.facecolor": "white",
}


@contextmanager
def figure(path: Path, **options: Any) -> Iterator[Any]:
    """Create a figure that is saved to `path` at the end of the block."""
    with canvas() as make:
        drawn = make(**options)
        yield drawn
        drawn.savefig(path, dpi=DPI, metadata=_METADATA.get(path.suffix.lower()))


@contextmanager
def canvas() -> Iterator[Callable[..., Any]]:
    """Yield a function that makes figures in the common style, to be drawn inside the block."""
    try:
        import matplotlib
        from matplotlib.backends.backend_agg import FigureCanvasAgg

        from dem_cli.results.post import verbatim_figure
    except ImportError:
        raise MissingExtra("drawing needs matplotlib", "plot") from None

    def make(**options: Any) -> Any:
        drawn = verbatim_figure.VerbatimFigure(layout="constrained", **options)
        FigureCanvasAgg(drawn)
        return drawn

    with matplotlib.rc_context(_STYLE | verbatim_figure.VERBATIM_STYLE), warnings.catch_warnings():
        warnings.filterwarnings("ignore", "Glyph .* missing")  # in the font: a box stands there
        yield make


def headline(figure: Any, summary: Mapping[str, Any]) -> None:
    """Draw the title of the run and its answer on one line."""
    load, mode = summary.get("failure_load"), summary.get("failure_mode")
    text = str(summary.get("title", ""))
    if summary.get("kind") == "limit" and summary.get("status") == "ok":
        text += ": limit analysis"
    elif summary.get("kind") == "safety":
        text += f": {_of_safety(summary)}"
    elif how := ending_words(summary, 3):
        text += f": {how}"
    elif load is None:
        text += f": {summary.get('status', 'unfinished')}"
    else:
        text += f": fails at λ = {load:.4g}" + (f" ({mode})" if mode else "")
    size = min(12.0, 12.0 * 8.5 * figure.get_figwidth() / len(text))
    figure.suptitle(text, x=0.01, ha="left", fontsize=size, fontweight="bold")


def number_logs(axis: Any, text: str = "{x:g}") -> None:
    """Use plain numbers along a logarithmic axis (`axes.xaxis`) that never overlap."""
    from matplotlib.ticker import LogLocator, NullFormatter

    low, high = axis.get_view_interval()
    short = _SHORT if axis.axis_name == "x" else _SHORT_UP
    axis.set_minor_locator(LogLocator(subs=(2.0, 5.0)))
    axis.set_major_formatter(text)
    axis.set_minor_formatter(text if high < short * low else NullFormatter())


def _of_safety(summary: Mapping[str, Any]) -> str:
    """Describe the answer of a safety analysis."""
    name = "F" if summary.get("vary") == "strength" else summary.get("vary")
    if summary.get("status") != "ok":
        return str(summary.get("status"))
    return f"stands at {name} = {summary['stands_at']:.5g}, fails at {summary['fails_at']:.5g}"


def length_unit(largest: float) -> tuple[float, str]:
    """Return factor from metres and unit name, so that the largest value is readable."""
    if largest >= 1.0:
        return 1.0, "m"
    return (1e3, "mm") if largest >= 1e-4 else (1e6, "µm")
