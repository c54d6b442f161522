"""What all pictures share."""

from __future__ import annotations

from dem_cli.results.post.style import figure, headline


def test_a_title_may_hold_what_the_font_lacks(tmp_path):
    """Warnings are errors here, and nothing to a user."""
    with figure(tmp_path / "out.png", figsize=(4.0, 2.0)) as drawn:
        headline(drawn, {"title": "A temple 🏛 <b>&\"' $x_1", "failure_load": 0.5})
    assert (tmp_path / "out.png").stat().st_size > 1000


def test_what_a_user_wrote_is_no_formula(tmp_path):
    words = "$\\frac{$ and $x_$"
    with figure(tmp_path / "out.svg") as drawn:
        axes = drawn.add_subplot(xlabel=words)
        axes.plot([0, 1], [1e-3, 1e4], label=words)
        axes.set_yscale("log")
        axes.set_xticks([0, 1], [words, "2"])
        axes.legend()
        headline(drawn, {"title": words, "failure_load": 0.5})
    said = [label.get_text() for label in axes.get_yticklabels()]
    assert "10⁻³" in said
    assert "10⁴" in said
