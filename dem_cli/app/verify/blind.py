"""Blind predictions: the hash that a case must keep, and the verdict on a measured value that came afterwards."""

from __future__ import annotations

import hashlib
import json
from collections.abc import Mapping
from pathlib import Path
from typing import Any

from dem_cli.case.reader import parse_toml, read_text
from dem_cli.case.reference import BLIND
from dem_cli.results.output.scalars import scalars

ADDED_LATER = ("value", "measured_in")  # keys of a blind [reference] that come after the prediction


def hash_of_case(path: Path) -> str:
    """Hash a case file (SHA-256) without comments, predictions and measured values. Raises CaseError, UsageError."""
    tables = parse_toml(path, read_text(path))
    references = tables.get("reference", [])
    for one in references if isinstance(references, list) else [references]:
        if one.get("kind") == BLIND:
            for key in ADDED_LATER:
                one.pop(key, None)
    kept = {key: value for key, value in tables.items() if key != "prediction"}
    return hashlib.sha256(json.dumps(kept, sort_keys=True, default=str).encode()).hexdigest()


def refusal(path: Path, case: Any) -> str | None:
    """Say why the predictions of a case are not valid; None where they are, or where nothing is blind."""
    if not case.blind:
        return None
    predicted = {one.quantity for one in case.prediction}
    for one in case.blind:
        if one.path not in predicted:
            return f"'{one.path}' is blind and has no prediction; `dem verify --predict {path}` writes it"
    now = hash_of_case(path)
    for prediction in case.prediction:
        if prediction.sha256 != now:
            hashes = f"SHA-256 {prediction.sha256[:12]}… then, {now[:12]}… now"
            allowed = "only 'value' and 'measured_in' may be added: put the others back, or predict another file"
            return f"keys changed after the prediction of {prediction.date} ({hashes}); {allowed}"
    return None


def blind_answers(summary: Mapping[str, Any], case: Any) -> list[dict[str, Any]]:
    """Judge blind references by the band of their predictions, whatever this version computes.

    value: what was measured, None before; found: what this version gives; error: prediction less measured value; state:
    "predicted" before a value is measured, then "passed" inside the band and "outside", which is no failure.
    """
    known, predictions = scalars(summary), {one.quantity: one for one in case.prediction}
    answers = []
    for reference in case.blind:
        prediction, value = predictions[reference.path], reference.value
        answer = {"value": value, "tolerance": None, "passed": None, "quantity": reference.path, "kind": BLIND}
        answer |= {"found": known.get(reference.path), "predicted": prediction.value}
        answer |= {key: list(getattr(prediction, key)) for key in ("numerical", "inputs", "band")}
        answer |= {"model": list(reference.model), "date": prediction.date, "version": prediction.version}
        answer |= {"source": reference.source, "reason": reference.reason, "error": None, "state": "predicted"}
        if value is not None:
            inside = prediction.band[0] <= value <= prediction.band[1]
            answer |= {"passed": inside, "state": "passed" if inside else "outside", "error": prediction.value - value}
            answer["measured_in"] = reference.measured_in
        answers.append(answer)
    return answers
