"""Verdicts in words: values, errors, what was allowed."""

from __future__ import annotations

from collections.abc import Mapping
from typing import Any

SHOWN_DIGITS = 5
ROUND_OFF = 1e-12  # of the expected value: round-off
VERDICTS = {"passed": "passed", "missed": "missed, as known", "failed": "FAILED", "met": "FAILED: met"}


def shown(value: Any, digits: int = SHOWN_DIGITS) -> str:
    """A number, word, truth or interval."""
    if isinstance(value, bool) or value is None:
        return {True: "true", False: "false", None: "–"}[value]
    if isinstance(value, (list, tuple)):
        return f"{shown(value[0], digits)} to {shown(value[1], digits)}"
    return value if isinstance(value, str) else number(value, digits)


def number(value: float, digits: int, sign: str = "") -> str:
    """A number with so many digits, large ones written out; sign: "+" for one in any case."""
    text = f"{value:{sign}.{digits}g}"
    return (f"{float(text):{sign}.0f}" if "e+0" in text else text).replace("-", "−")


def found(answer: Mapping[str, Any]) -> str:
    """The value found; of a curve the largest of its loads where those of the reference are."""
    value = answer["found"]
    return f"up to {shown(max(value))}" if "displacements" in answer and value else shown(value)


def expected(answer: Mapping[str, Any]) -> str:
    """The value expected; of a curve its peak and how many points it has."""
    if "displacements" in answer:
        return f"up to {shown(max(answer['value']), 6)} in {len(answer['value'])} points"
    return shown(answer["value"], 6)


def off(answer: Mapping[str, Any]) -> str:
    """How far off, in the unit of the quantity; "inside" an interval."""
    value = answer["error"]
    if "displacements" in answer:
        return "–" if value is None else f"{number(value, 2)} on average"
    if value is None:
        return "–" if answer["found"] is None else ""
    if isinstance(answer["value"], list) and value == 0.0:
        return "inside"
    size = max(map(abs, answer["value"])) if isinstance(answer["value"], list) else abs(answer["value"])
    return "0" if abs(value) <= ROUND_OFF * size else number(value, 2, "+")


def share(answer: Mapping[str, Any]) -> float | None:
    """How far off, over the expected value (of an interval: its nearer end); None where that says nothing."""
    value, expected = answer["error"], answer["value"]
    if "displacements" in answer:
        return None if value is None else value / max(expected)
    if isinstance(expected, list):
        expected = expected[0] if value is not None and value < 0.0 else expected[1]
    return value / abs(expected) if value is not None and expected else None


def allowed(answer: Mapping[str, Any]) -> str:
    """The tolerance, in the unit of the quantity."""
    return f"± {shown(answer['tolerance'], 2)}" if answer["tolerance"] else ""


def judgement(answer: Mapping[str, Any]) -> str:
    """A verdict in a sentence."""
    if "problem" in answer:
        return str(answer["problem"])
    what = f"{answer['quantity']} is {found(answer)}, expected {expected(answer)} {allowed(answer)}"
    if "missed" not in answer:
        return what.strip()
    if answer["passed"]:
        return f"{what.strip()}: met, but [reference] says that it is missed: {answer['missed']}"
    return f"{what.strip()}: missed, as known: {answer['missed']}"
