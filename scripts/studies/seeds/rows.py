"""Rows of results of the seeds: what is said of each printed number, and the verdict where dem computes it."""

from __future__ import annotations

import tomllib
from collections.abc import Mapping
from dataclasses import dataclass
from functools import cache
from pathlib import Path
from typing import Any

from reference import results

from dem_cli.case.tolerance_rules import allowance
from dem_cli.results.output.reference import passes
from studies import storage
from studies.places import ROOT
from studies.seeds.computed import COMPUTED, table_tests

FILE = Path(__file__).with_name("rows.toml")
KINDS = {"experiment": "experiment", "DEM (author)": "code", "exact": "exact"}  # of the data book, of [reference]
RESOLUTION = 0.002  # of loads that studies find: the usual one of a pushover
UNITS = ("m", "s", "N", "Pa", "Pa/m", "rad", "deg", "Hz", "g")
SECOND = {"mode": "failure mode", "top_displacement_m": "displacement of the top before failure [m]"}
MET, MISSED, INPUT, NOT, UNKNOWN = "met", "missed", "input", "not computed", "not run"
REPEAT = "repeats"
ORIGINS = {"inferred_from": "an input of the case was inferred from it", "chosen_by": "an input was chosen by it"}


@dataclass(frozen=True)
class SeedRow:
    """A printed number: where it is, what dem has, the verdict (one of the words above), where that is, and why."""

    book: str
    name: str
    what: str
    where: str
    kind: str
    printed: Any
    verdict: str
    compared: Any = None  # the printed number as the case or the page has it
    found: Any = None
    allowed: float | None = None
    page: str = ""  # of a case or a page of docs/, as seen from docs/
    why: str = ""


def rows() -> list[SeedRow]:
    """All of them, by book."""
    return [row_of(name, key, said) for name, table in told().items() for key, said in table.items()]


@cache
def told() -> dict[str, dict[str, dict[str, Any]]]:
    """rows.toml: book, id, what is said of it."""
    return tomllib.loads(FILE.read_text(encoding="utf-8"))


def printed_by_seeds(name: str) -> dict[str, dict[str, Any]]:
    """Results of a data book that a seed prints."""
    return {key: row for key, row in results(name).items() if row["basis"] == "seed"}


def ids_of(name: str, key: str) -> list[str]:
    """Results that a row is about: one, or the first to the last of a table."""
    first, _, last = key.partition(" to ")
    found = list(results(name))
    return found[found.index(first) : found.index(last) + 1] if last else [result_of(name, key)[0]["id"]]


@cache
def origins() -> dict[str, str]:
    """BOOK.ID of results from which an input of a case came, by the keys of the cases, and how."""
    found: dict[str, str] = {}
    for path in sorted((ROOT / "cases").rglob("*.toml")):
        case = tomllib.loads(path.read_text(encoding="utf-8"))
        for key, words in ORIGINS.items():
            for name in case.get(key, ()):
                found.setdefault(name, f"{words} ({path.stem})")
    return found


def result_of(name: str, key: str) -> tuple[dict[str, Any], Any]:
    """The [[result]] of an id, and its value, or that of its other number: `ID.KEY`."""
    found = results(name)
    key = key.partition(" to ")[0]
    if key in found:
        return found[key], found[key]["value"]
    main, _, second = key.rpartition(".")
    return found[main], found[main][second]


def row_of(name: str, key: str, said: Mapping[str, Any]) -> SeedRow:
    """What is said of a result, with the verdict."""
    result, value = result_of(name, key)
    unit = result["unit"] if result["unit"] in UNITS else ""
    what = (
        SECOND[key.rpartition(".")[2]]
        if key.rpartition(".")[2] in SECOND
        else f"{result['quantity']} [{unit}]".replace(" []", "")
    )
    common = {"book": name, "name": key, "what": what, "where": result["where"], "kind": KINDS[result["kind"]]}
    common["printed"] = value
    if "repeats" in said:
        return SeedRow(**common, verdict=REPEAT, why="; ".join(filter(None, (said["repeats"], said.get("how", "")))))
    if "input" in said:
        return SeedRow(**common, verdict=INPUT, why=said["input"])
    if "no" in said:
        return SeedRow(**common, verdict=NOT, why=said["no"])
    of_dem = _of_case(result, value, said) if "case" in said else _of_study(result, said)
    if origin := origins().get(f"{name}.{key}"):
        of_dem |= {"verdict": INPUT, "why": "; ".join(filter(None, (said.get("how", ""), origin)))}
    elif "inferred" in said and of_dem["verdict"] == MET:
        of_dem |= {"verdict": INPUT, "why": said["inferred"]}
    return SeedRow(**common | of_dem)


def asked(value: Any, said: Mapping[str, Any]) -> tuple[str, Any]:
    """Quantity and value of the [reference] that a row points to."""
    return said.get("quantity", "failure_load"), said.get("value", value)


@cache
def verified() -> dict[str, dict[str, Any]]:
    """What `dem verify` found, by case."""
    return {record["case"]: record for record in storage.read("verification").get("cases", ())}


def _of_case(result: Mapping[str, Any], value: Any, said: Mapping[str, Any]) -> dict[str, Any]:
    """Verdict of `dem verify`."""
    quantity, wanted = asked(value, said)
    page = f"../cases/{said['case']}.toml"
    found = [
        answer
        for answer in verified().get(page, {}).get("references", ())
        if (answer["quantity"], answer["value"]) == (quantity, wanted)
        and answer["kind"] in (KINDS[result["kind"]], "inference")
    ]
    if not found:
        return {"verdict": UNKNOWN, "page": page}
    (answer, *_), why = found, ""
    verdict = MET if answer["passed"] else MISSED
    if answer["kind"] == "inference":
        verdict, why = INPUT, "" if "how" in said else ORIGINS["inferred_from"]
    elif verdict == MISSED:
        why = answer.get("missed", "")
    return {"verdict": verdict, "found": answer["found"], "allowed": answer["tolerance"], "page": page,
            "compared": wanted, "why": "; ".join(filter(None, (said.get("how", ""), why)))}  # fmt: skip


def _of_study(result: Mapping[str, Any], said: Mapping[str, Any]) -> dict[str, Any]:
    """What a page of docs/ has, judged by the same rule."""
    compute, page = COMPUTED[said["study"]]
    found, printed = compute(dict(result))
    allowed = None
    if compute is table_tests:
        right, baseline = found
        well = right > baseline
        printed, found = f"{printed} outcomes", f"{right} of them"
    elif found is None:
        well = False
    elif isinstance(found, (bool, list)):
        well = found == printed
    else:
        wanted = tuple(printed) if isinstance(printed, list) else float(printed)
        allowed = _allowance(result, wanted if isinstance(wanted, tuple) else (wanted,))
        well = passes(found, wanted, allowed)
    why = "" if well else said.get("missed", "")
    shown = {"printed": printed} if compute is table_tests else {}
    return shown | {"verdict": MET if well else MISSED, "found": found, "allowed": allowed, "page": f"{page}.md",
            "compared": printed, "why": "; ".join(filter(None, (said.get("how", ""), why)))}  # fmt: skip


def _allowance(result: Mapping[str, Any], bounds: tuple[float, ...]) -> float:
    """By the rule of `dem verify`."""
    measured = str(result.get("tolerance_kind", "")).startswith("standard deviation")
    quantity = "failure_load" if result["unit"] == "-" else ""
    return allowance(
        KINDS[result["kind"]], quantity, bounds, result["tolerance"] if measured else None, None, RESOLUTION
    )
