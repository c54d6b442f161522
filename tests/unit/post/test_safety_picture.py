"""safety.png: numbers of its axes that can be read."""

from __future__ import annotations

import pytest

pytest.importorskip("matplotlib")

from dem_cli.results.post import safety, style


class Drawn:
    """What a safety analysis left, as far as the picture asks."""

    kind = "safety"

    def __init__(self, steps):
        values = [1.0 + 0.1 * i for i in range(len(steps))]
        runs = [{"value": v, "steps": n, "stands": i < 1} for i, (v, n) in enumerate(zip(values, steps))]
        self.summary = {
            "title": "An arch", "kind": "safety", "status": "ok", "vary": "strength", "reduce": ["friction"],
            "runs": runs, "stands_at": 1.0, "fails_at": 1.1,
        }  # fmt: skip


@pytest.mark.parametrize("steps", [(600, 53_000), (1300, 45_000), (500, 700), (20_000, 4_000_000), (3, 9_000_000)])
def test_steps_are_written_apart(tmp_path, monkeypatch, steps):
    """9,000 stood in 8,000 and 10,000."""
    drawn, headline = [], style.headline
    monkeypatch.setattr(style, "headline", lambda figure, summary: (drawn.append(figure), headline(figure, summary)))
    safety.draw_safety(Drawn(steps), tmp_path / "safety.png")
    (figure,) = drawn
    figure.canvas.draw()
    axis = figure.axes[0].yaxis
    low, high = axis.get_view_interval()
    seen = [tick.label1 for tick in [*axis.get_major_ticks(), *axis.get_minor_ticks()] if low <= tick.get_loc() <= high]
    boxes = [label.get_window_extent() for label in seen if label.get_text()]
    heights = sorted((box.y0, box.y1) for box in boxes)
    assert len(heights) >= 2
    assert all(below[1] <= above[0] for below, above in zip(heights, heights[1:]))
