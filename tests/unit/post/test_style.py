"""What all pictures share."""

from __future__ import annotations

from dem_cli.post.style import figure, headline


def test_a_title_may_hold_what_the_font_lacks(tmp_path):
    """Warnings are errors here, and nothing to a user."""
    with figure(tmp_path / "out.png", figsize=(4.0, 2.0)) as drawn:
        headline(drawn, {"title": "A temple 🏛 <b>&\"' $x_1", "failure_load": 0.5})
    assert (tmp_path / "out.png").stat().st_size > 1000
