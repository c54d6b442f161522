"""Format verdicts: values, errors, tolerances."""

from __future__ import annotations

from collections.abc import Mapping
from typing import Any

SHOWN_DIGITS = 5
ROUND_OFF = 1e-12  # of the expected value: round-off
VERDICTS = {"passed": "passed", "missed": "missed, as known", "failed": "FAILED", "met": "FAILED: met"}
VERDICTS |= {"predicted": "predicted", "outside": "missed"}  # of blind references


def shown(value: Any, digits: int = SHOWN_DIGITS) -> str:
    """Format a number, text, truth value or interval."""
    if isinstance(value, bool) or value is None:
        return {True: "true", False: "false", None: "–"}[value]
    if isinstance(value, (list, tuple)):
        return f"{shown(value[0], digits)} to {shown(value[1], digits)}"
    return value if isinstance(value, str) else number(value, digits)


def number(value: float, digits: int, sign: str = "") -> str:
    """Format a number with so many digits, large ones written out; sign: "+" to show it always."""
    text = f"{value:{sign}.{digits}g}"
    return (f"{float(text):{sign}.0f}" if "e+0" in text else text).replace("-", "−")


def found(answer: Mapping[str, Any]) -> str:
    """Format the value found, of a blind reference that predicted; of a curve its largest load there."""
    value = answer.get("predicted", answer["found"])
    return f"up to {shown(max(value))}" if "displacements" in answer and value else shown(value)


def expected(answer: Mapping[str, Any]) -> str:
    """Format the value expected; of a curve its peak and number of points."""
    if "displacements" in answer:
        return f"up to {shown(max(answer['value']), 6)} in {len(answer['value'])} points"
    return shown(answer["value"], 6)


def off(answer: Mapping[str, Any]) -> str:
    """Format the error in the unit of the quantity; "inside" an interval."""
    value = answer["error"]
    if "predicted" in answer and value is None:
        return "–"
    if "displacements" in answer:
        return "–" if value is None else f"{number(value, 2)} on average"
    if value is None:
        return "–" if answer["found"] is None else ""
    if isinstance(answer["value"], list) and value == 0.0:
        return "inside"
    size = max(map(abs, answer["value"])) if isinstance(answer["value"], list) else abs(answer["value"])
    return "0" if abs(value) <= ROUND_OFF * size else number(value, 2, "+")


def share(answer: Mapping[str, Any]) -> float | None:
    """Return the relative error (of an interval: over its nearer end); None where it is undefined."""
    value, expected = answer["error"], answer["value"]
    if expected is None:  # not measured yet
        return None
    if "displacements" in answer:
        return None if value is None else value / max(expected)
    if isinstance(expected, list):
        expected = expected[0] if value is not None and value < 0.0 else expected[1]
    return value / abs(expected) if value is not None and expected else None


def allowed(answer: Mapping[str, Any]) -> str:
    """Format the tolerance, or the band of a prediction, in the unit of the quantity."""
    if "band" in answer:
        return shown(answer["band"], 4)
    return f"± {shown(answer['tolerance'], 2)}" if answer["tolerance"] else ""


def judgement(answer: Mapping[str, Any]) -> str:
    """Format a verdict as a sentence."""
    if "problem" in answer:
        return str(answer["problem"])
    if "predicted" in answer:
        return _of_prediction(answer)
    what = f"{answer['quantity']} is {found(answer)}, expected {expected(answer)} {allowed(answer)}"
    if "missed" not in answer:
        return what.strip()
    if answer["passed"]:
        return f"{what.strip()}: met, but [reference] says that it is missed: {answer['missed']}"
    return f"{what.strip()}: missed, as known: {answer['missed']}"


def _of_prediction(answer: Mapping[str, Any]) -> str:
    """Format the state of a blind reference as a sentence, and what this version finds where that is another value."""
    what = f"{answer['quantity']} was predicted on {answer['date']} as {shown(answer['predicted'])}, {allowed(answer)}"
    if answer["value"] is None:
        text = f"{what}; nothing is measured yet"
    else:
        side = "outside" if answer["state"] == "outside" else "inside"
        text = f"{what}; measured {shown(answer['value'], 6)}, {side}"
    low, high = answer["numerical"]
    today, slack = answer["found"], 1e-3 * abs(answer["predicted"])
    moved = not isinstance(today, (int, float)) or not low - slack <= today <= high + slack
    return f"{text}; this version finds {shown(today)}" if moved else text
