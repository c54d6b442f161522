"""Figures with verbatim text: names of runs or joints are never formulas, whatever `$` they contain."""

from __future__ import annotations

import re
from typing import Any

from matplotlib.figure import Figure
from matplotlib.ticker import LogFormatterMathtext, LogFormatterSciNotation

VERBATIM_STYLE = {"text.parse_math": False}
RAISED = str.maketrans("-0123456789", "⁻⁰¹²³⁴⁵⁶⁷⁸⁹")


class VerbatimFigure(Figure):
    """Figure whose logarithmic axes need no formulas either."""

    def draw(self, renderer: Any) -> None:
        """Draw the figure after its axes are numbered in plain letters."""
        for axes in self.axes:
            for axis in (axes.xaxis, axes.yaxis):
                for kind in ("major", "minor"):
                    formatter = getattr(axis, f"get_{kind}_formatter")()
                    if isinstance(formatter, LogFormatterMathtext) and not isinstance(formatter, PowerFormatter):
                        getattr(axis, f"set_{kind}_formatter")(PowerFormatter(labelOnlyBase=formatter.labelOnlyBase))
        super().draw(renderer)


class PowerFormatter(LogFormatterSciNotation):
    """Numbers at a logarithmic axis: 10³ instead of a formula for it."""

    def __call__(self, x: float, pos: int | None = None) -> str:
        """Return the number beside a tick with its exponent raised."""
        text = super().__call__(x, pos).replace(r"$\mathdefault{", "").replace("}$", "").replace(r"\times", "×")
        return re.sub(r"\^\{(-?\d+)\}", lambda found: found[1].translate(RAISED), text)
