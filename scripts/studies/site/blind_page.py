"""docs/blind.md: what was predicted before it was measured, from the case files of cases/blind."""

from __future__ import annotations

import tomllib
from typing import Any

from dem_cli.app.verify.verdict_words import shown
from studies.places import CASES
from studies.template import filled, minus, table

SHELF = CASES / "blind"
HEAD = ("case", "what", "predicted", "numerical", "inputs", "model", "band", "measured")
DRIFT_HEIGHT = 1.325  # m, of the push on granite walls


def text() -> str:
    """The page as it should be."""
    cases = {path.stem: tomllib.loads(path.read_text(encoding="utf-8")) for path in sorted(SHELF.glob("*.toml"))}
    groups = {name: _rows({stem: case for stem, case in cases.items() if stem.startswith(name)})
              for name in ("arch", "wall", "granite")}  # fmt: skip
    return filled("site/blind.md.j2", tables=groups, alternatives=_alternatives(cases), drifts=_drifts(cases))


def _references(case: dict[str, Any]) -> list[dict[str, Any]]:
    found = case["reference"]
    return found if isinstance(found, list) else [found]


def _rows(cases: dict[str, dict[str, Any]]) -> str:
    """A row for each prediction of these cases."""
    lines = []
    for stem, case in cases.items():
        predictions = {one["quantity"]: one for one in case.get("prediction", [])}
        for number, reference in enumerate(_references(case)):
            found = predictions.get(reference["quantity"])
            if found is None:  # not predicted yet: `dem verify` and a test refuse such a case
                continue
            low, high = reference["model"]
            model = f"{50.0 * (low + high):+.3g} ± {50.0 * (high - low):.3g} %"
            bands = [shown(found[key], 5) for key in ("numerical", "inputs")]
            name = f"[{stem}](../cases/blind/{stem}.toml)" if number == 0 else ""
            measured = shown(reference["value"]) if "value" in reference else "–"
            what = reference["source"].partition(";")[0]
            lines.append(
                (name, what, shown(found["value"]), *bands, minus(model), f"**{shown(found['band'], 5)}**", measured)
            )
    return table(HEAD, lines)


def _drifts(cases: dict[str, dict[str, Any]]) -> str:
    """Displacements at which 80 % of the peak is left, as drifts of the height of the push."""
    lines = []
    for stem, case in cases.items():
        for one in case.get("prediction", []):
            if one["quantity"].endswith("ultimate_displacement"):
                low, high = (100.0 * end / DRIFT_HEIGHT for end in one["band"])
                value = 100.0 * one["value"] / DRIFT_HEIGHT
                lines.append((stem, f"{value:.1f} %", f"{low:.1f} to {high:.1f} %"))
    return table(("case", "drift where 80 % is left", "band"), lines)


def _alternatives(cases: dict[str, dict[str, Any]]) -> str:
    """Rows of the varied inputs, once for all cases that vary them."""
    found: dict[tuple[str, str], list[str]] = {}
    for stem, case in cases.items():
        for one in case.get("alternative", []):
            found.setdefault((one.get("of", "input"), one["why"]), []).append(stem)
    lines = [(of, why, ", ".join(dict.fromkeys(stems))) for (of, why), stems in sorted(found.items())]
    return table(("of", "what was run besides", "cases"), lines)
