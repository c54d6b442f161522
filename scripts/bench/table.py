"""Markdown tables, and figures as people read them."""

from __future__ import annotations

from collections.abc import Iterable, Sequence


def lines_of(head: Sequence[str], rows: Iterable[Sequence[str]]) -> list[str]:
    """A Markdown table."""
    return ["| " + " | ".join(cells) + " |" for cells in (head, ["---"] * len(head), *rows)]


def percent(error: float | None) -> str:
    """A relative error: two significant digits, never more than three places."""
    if error is None:
        return "–"
    value = 100.0 * error
    places = 1 if abs(value) >= 9.95 else 2 if abs(value) >= 0.0995 else 3
    if abs(value) < 5e-4:
        return "0.000 %"
    return f"{value:+.{places}f} %".replace("-", "−")


def seconds(value: float) -> str:
    """CPU seconds with about two digits: 0.052 s."""
    return f"{value:.3f} s" if value < 0.1 else f"{value:.2f} s" if value < 10 else f"{value:,.0f} s"


def count(value: int | None) -> str:
    """How many."""
    return "–" if value is None else f"{value:,}"
