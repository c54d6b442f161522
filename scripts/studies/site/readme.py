"""README.md with its table of verification (docs/data/verification.json) and the count of results of the seeds."""

from __future__ import annotations

import re
from pathlib import Path
from typing import Any

from bench.table import percent

from studies import storage
from studies.places import ROOT
from studies.seeds.page import sentence
from studies.template import minus
from studies.template import table as markdown

MARKED = re.compile(r"(<!-- verification -->\n).*?(<!-- end -->)", re.DOTALL)
FROM = {"exact": "mechanics", "experiment": "a test", "code": "another program"}
ROWS = (  # case, kind of its reference (the first of that kind is shown), what it is
    ("wall_21_mu050", "exact", "21-block wall, friction 0.5: its top course slides"),
    ("wall_21", "exact", "the same, friction 0.6"),
    ("wall_21_mu075", "exact", "the same, friction 0.75: it turns over"),
    ("wall_3", "exact", "wall of 231 blocks"),
    ("column_14", "exact", "column of 14 blocks"),
    ("arch_21", "exact", "arch of 21 voussoirs: four hinges"),
    ("arch_21_mu040", "exact", "the same, friction 0.4: joints slide"),
    ("cohesion_block", "exact", "block held by friction and cohesion"),
    ("least_thickness_arch", "exact", "least ring of a semicircular arch of radius 10 m [m]"),
    ("safety_incline", "exact", "factor of safety of a block on an incline"),
    ("settlement_portal", "exact", "keystone of an arch whose support settles [m]"),
    ("rocking_free", "exact", "first swing of a block that rocks [rad]"),
    ("sliding_pulse", "exact", "slip left by a pulse [m]"),
    ("wall_21_profile", "experiment", "wall of 21 real blocks, joints calibrated on a column"),
    ("wall_110_profile", "experiment", "wall of 110 real blocks, the same joints"),
    ("griffith_wall", "experiment", "wall bent out of its plane"),
    ("shear_wall_ws100", "experiment", "dry-stone wall under 100 kN, pushed [N]"),
    ("church_a", "code", "slice of a church as it is, sizes inferred"),
    ("church_b", "code", "the same before 1954, sizes inferred"),
)


def text() -> str:
    """The page as it should be."""
    page = (ROOT / "README.md").read_text(encoding="utf-8")
    table = markdown(("case", "known from", "known", "dem", "error"), rows())
    return MARKED.sub(lambda found: f"{found[1]}{table}\n\n{met()}\n{found[2]}", page)


def records() -> list[dict[str, Any]]:
    """What `dem verify` found, a record per case."""
    return storage.read("verification")["cases"]


def rows() -> list[tuple[str, ...]]:
    """A row for each of ROWS."""
    found = {Path(record["case"]).stem: record["references"] for record in records()}
    return [row(about, kind, found[name]) for name, kind, about in ROWS]


def met() -> str:
    """How many exact references are met, and what became of the results of the seeds."""
    exact = [answer for record in records() for answer in record["references"] if answer["kind"] == "exact"]
    failed = sum(answer["state"] in ("failed", "met") for record in records() for answer in record["references"])
    states = f" References that are not as their case says: {failed}." if failed else ""
    passed = sum(answer["passed"] for answer in exact)
    return (
        f"Exact references that are met: {passed} of {len(exact)}.{states} {sentence()} [All of them](docs/seeds.md)."
    )


def row(about: str, kind: str, answers: list[dict[str, Any]]) -> tuple[str, ...]:
    """What it is, where the reference comes from, the reference, ours, the error; a miss is said."""
    answer = next(one for one in answers if one["kind"] == kind)
    found, wanted = answer["found"], answer["value"]
    error = percent(found / wanted - 1.0) + ("" if answer["passed"] else ": missed")
    return about, FROM[kind], number(wanted), number(found), error


def number(value: float) -> str:
    """Four digits."""
    return minus(f"{value:,.0f}" if abs(value) >= 1e4 else f"{value:.4g}")
