"""capacity.png: a legend with long lines stays inside the picture; a curve off the failure load says so in it."""

from __future__ import annotations

from types import SimpleNamespace

import numpy as np
import pytest
from matplotlib.backends.backend_agg import FigureCanvasAgg
from matplotlib.figure import Figure
from matplotlib.lines import Line2D

from dem_cli.results.post import capacity
from dem_cli.results.post.capacity import _draw_legend, draw_capacity


@pytest.mark.parametrize(("count", "letters"), [(1, 4), (3, 8), (8, 25), (4, 60), (8, 5)])
def test_legend_is_no_wider_than_the_figure(count, letters):
    figure = Figure(layout="constrained", figsize=(7.4, 4.3))
    FigureCanvasAgg(figure)
    figure.subplots()
    _draw_legend(figure, [Line2D([], []) for _ in range(count)], ["x" * letters] * count)
    figure.canvas.draw()
    (legend,) = figure.legends
    box = legend.get_window_extent()
    assert box.x0 >= 0.0
    assert box.x1 <= figure.bbox.width
    assert len(legend.get_texts()) == count
    rows = len({round(text.get_window_extent().y0) for text in legend.get_texts()})
    assert rows == 1 or rows < count or letters > 50  # no more rows than it takes


@pytest.mark.parametrize(("peak", "words"), [(0.7, "peaks 9.4 % above"), (0.6, "peaks 6.2 % below"), (0.64, "")])
def test_a_curve_off_the_failure_load_says_so_in_the_picture_and_has_no_mark(tmp_path, monkeypatch, peak, words):
    drawn = []
    monkeypatch.setattr(capacity.style, "headline", lambda figure, summary: drawn.append(figure))
    history = np.zeros(20, [("displacement", float), ("load", float), ("step", int), ("stage", "U10")])
    history["displacement"], history["step"] = np.linspace(0.0, 0.01, 20), np.arange(20)
    history["load"], history["stage"] = peak, "collapse"
    summary = {"failure_load": 0.64, "failure_load_bracket": [0.64, 0.641], "displacement_at_failure": 0.005}
    summary |= {"peak_of_curve": peak, "curve_off_the_load": bool(words), "curve_joint_stiffness": 4e4}
    draw_capacity(SimpleNamespace(history=history, summary=summary), tmp_path / "capacity.png")
    axis = drawn[0].axes[0]
    said = [text.get_text() for text in axis.texts]
    assert [words in text for text in said if "only its shape counts" in text] == ([True] if words else [])
    assert len([line for line in axis.lines if line.get_marker() == "o"]) == (0 if words else 1)
    assert "joints of the solver's choice, kn·h/W = 4e+04" in axis.get_title(loc="left") + axis.get_title()
    assert (tmp_path / "capacity.png").stat().st_size > 0


@pytest.mark.parametrize(
    ("reference", "labels"),
    [
        (None, []),
        ({"quantity": "failure_load", "value": 0.6, "tolerance": 0.0018, "passed": True}, ["reference 0.6 ± 0.0018"]),
        (
            [
                {"quantity": "failure_load", "value": [0.5, 0.6], "tolerance": 0.03, "passed": True},
                {"quantity": "failure_mode", "value": "sliding", "tolerance": None, "passed": True},
            ],
            ["reference 0.5 to 0.6 ± 0.03"],
        ),
    ],
)
def test_lines_of_references_that_are_loads(tmp_path, monkeypatch, reference, labels):
    """One reference, several, an interval, a word: the README's first case has three."""
    drawn = []
    monkeypatch.setattr(capacity.style, "headline", lambda figure, summary: drawn.append(figure))
    history = np.zeros(5, [("displacement", float), ("load", float), ("step", int), ("stage", "U10")])
    history["displacement"], history["load"], history["stage"] = np.linspace(0.0, 0.01, 5), 0.6, "loading"
    history["step"] = np.arange(5)
    summary = {"failure_load": 0.6, "failure_load_bracket": [0.6, 0.601], "reference": reference}
    draw_capacity(SimpleNamespace(history=history, summary=summary), tmp_path / "capacity.png")
    found = drawn[0].axes[0].get_legend_handles_labels()[1]
    assert [label for label in found if label.startswith("reference")] == labels
