"""capacity.png: a legend with long lines stays inside the picture."""

from __future__ import annotations

import pytest
from matplotlib.backends.backend_agg import FigureCanvasAgg
from matplotlib.figure import Figure
from matplotlib.lines import Line2D

from dem_cli.post.capacity import _draw_legend


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
