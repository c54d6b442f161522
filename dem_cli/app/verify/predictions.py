"""Predict blind cases: run each as it stands and with every alternative, and append the bands to its file."""

from __future__ import annotations

import json
from collections.abc import Iterable, Mapping, Sequence
from datetime import UTC, datetime
from pathlib import Path
from typing import Any, NamedTuple

from dem_cli.app.verify.blind import hash_of_case
from dem_cli.errors import SolverError
from dem_cli.results.output.scalars import scalars
from dem_cli.version import __version__

DIGITS = 6  # of the numbers of a prediction
HEAD = "# Written by `dem verify --predict`. From here on only 'value' and 'measured_in' may be added above."


class PredictionRun(NamedTuple):
    """One run of a prediction: the case as it stands (alternative None), or with one of its alternatives."""

    path: Path
    alternative: int | None
    changes: Mapping[str, Any]  # key of the case -> value

    @property
    def name(self) -> str:
        """Name of the run in messages."""
        return str(self.path) if self.alternative is None else f"{self.path}: alternative.{self.alternative}"


def runs_of(path: Path, case: Any) -> list[PredictionRun]:
    """List the runs that a prediction of a case needs, that of the case as it stands first."""
    alternatives = [PredictionRun(path, i, one.set) for i, one in enumerate(case.alternative)]
    return [PredictionRun(path, None, {}), *alternatives]


def text_of_predictions(path: Path, case: Any, summaries: Sequence[Mapping[str, Any]]) -> str:
    """Return the [[prediction]] tables of a case as TOML. summaries: one for each of its runs, in their order.

    Raises SolverError where a run has no such number.
    """
    sha256, today = hash_of_case(path), datetime.now(UTC).date().isoformat()
    tables = [HEAD]
    for reference in case.blind:
        values = [_number(summary, reference.path, run) for summary, run in
                  zip(summaries, runs_of(path, case), strict=True)]  # fmt: skip
        found = {"quantity": reference.path, "value": _rounded(values[0])}
        found |= bands(
            values, [one.of for one in case.alternative], _bracket(summaries[0], reference.path), reference.model
        )
        found |= {"date": today, "version": __version__, "sha256": sha256}
        tables.append("\n".join(["[[prediction]]", *(f"{key} = {json.dumps(value)}" for key, value in found.items())]))
    return "\n\n".join(tables) + "\n"


def bands(
    values: Sequence[float], kinds: Sequence[str], bracket: Iterable[float], model: tuple[float, float]
) -> dict[str, list[float]]:
    """Compute the bands of a prediction: numerical, of inputs, and of both with the error of the model.

    values: of the case, then of its alternatives; kinds: "numerical" or "input" of each alternative; bracket: further
    values of the case that belong to the numerical ones. The differences of both to the value are added up, and the
    outcome is multiplied by 1 + the error of the model.
    """
    value, others = values[0], list(zip(kinds, values[1:], strict=True))
    numerical = [value, *bracket, *(one for kind, one in others if kind == "numerical")]
    inputs = [value, *(one for kind, one in others if kind == "input")]
    ends = [end(numerical) + end(inputs) - value for end in (min, max)]
    corners = [one * (1.0 + error) for one in ends for error in model]
    found = {"numerical": numerical, "inputs": inputs, "band": corners}
    return {key: [_rounded(min(those)), _rounded(max(those))] for key, those in found.items()}


def _number(summary: Mapping[str, Any], quantity: str, run: PredictionRun) -> float:
    value = scalars(summary).get(quantity)
    if isinstance(value, (bool, str)) or value is None:
        has = f"is {value!r}" if quantity in scalars(summary) else "is missing in the summary"
        raise SolverError(f"{run.name}: '{quantity}' {has}; a prediction is of a number (status: {summary['status']})")
    return float(value)


def _bracket(summary: Mapping[str, Any], quantity: str) -> list[float]:
    """Return both ends of the bracket over a quantity; empty where it has none."""
    return [float(end) for end in summary.get(f"{quantity}_bracket") or []]


def _rounded(value: float) -> float:
    return float(f"{value:.{DIGITS}g}")
