"""Write docs/verification.md: every case with a known answer and the computed one, from the records alone."""

from __future__ import annotations

from collections.abc import Iterable, Sequence
from pathlib import PurePosixPath
from typing import Any

from dem_cli.app.verify.case_selection import APART, SHELVES
from dem_cli.app.verify.records import Record, apart, counts, on_shelves
from dem_cli.app.verify.verdict_words import VERDICTS, allowed, expected, found, off, share, shown
from dem_cli.case.tolerance_rules import RULES

ABOUT = {
    "verification": "Exact answers: closed forms, limit analysis, motions integrated apart from dem to full accuracy. "
    "They say whether the equations are solved right.",
    "bounds": "Intervals between two bounds of mechanics. An answer outside is wrong; one inside need not be right.",
    "validation": "Experiments. They say whether these are the right equations, with the properties that the authors "
    "give.",
    "cross-code": "Answers of other programs to the same question, as their authors printed them.",
    "blind": "Predicted before they were measured, with numbers, date, version and hash of the case: see "
    "[blind predictions](blind.md). A band is the numerical one and that of the inputs, added up, with the error of "
    "the model on top. A measured value is met inside the band; nothing is adjusted afterwards.",
    APART: "Numbers from which an input of their own case was inferred, or by which it was chosen, as sizes of a lost "
    "figure or a calibrated joint. That they come out shows that the arithmetic was done and nothing about dem: they "
    "count nowhere else.",
}
TITLES = {APART: "Arithmetic of inference"}
KEPT = "\N{NO-BREAK SPACE}"
BLIND_HEAD = ("case", "quantity", "predicted (numerical band)", "inputs", "model", "band", "measured", "verdict")
TABLE_HEAD = ("case", "quantity", "ours", "reference", "difference", "error", "allowed", "verdict")
INTRO = """# What dem gets right, and what it misses

Written by `dem verify cases --write docs/verification.md`; do not edit. Every case file under `cases/` that has a
`[reference]` was run as it stands and compared. A test fails when this page does not belong to the case files.

*difference*: ours less the reference, in the unit of the quantity; *error*: the same over the reference; of a range,
beyond its nearer end. *allowed*: what passes, by one rule for each kind (`dem_cli/case/tolerance_rules.py`); a star
marks a tolerance of the case's own, whose reason stands below the table. A *known miss* is declared in its case file
with what is known of the cause; if it is suddenly met, that fails too.

"""
RULE_TITLES = {kind: f"**{kind}** ({SHELVES[kind]})" for kind in RULES}


def page(records: Iterable[Record], version: str) -> str:
    """Create the page as Markdown. Paths of cases are relative to the page."""
    records = sorted(records, key=lambda record: record["case"])
    rules = [f"* {RULE_TITLES[kind]}: {rule}." for kind, rule in RULES.items()]
    lines = [INTRO + "\n".join(rules), "", *_summary(records), ""]
    for shelf in ABOUT:
        of_shelf = on_shelves((r for r in records if "error" not in r), [shelf])
        if of_shelf:
            of_shelf.sort(key=lambda record: f"/{shelf}/" not in record["case"])
            lines += [
                f"## {TITLES.get(shelf, shelf.capitalize())}",
                "",
                ABOUT[shelf],
                "",
                *(_predictions(of_shelf) if shelf == "blind" else _table(of_shelf)),
                "",
                *_sources(of_shelf),
            ]
    broken = [record for record in records if "error" in record]
    if broken:
        lines += ["## Not solved", "", *(f"* {_link(r)}: {_cell(r['error'])}" for r in broken), ""]
    return "\n".join([*lines, f"dem {version}."]) + "\n"


def _summary(records: Sequence[Record]) -> list[str]:
    """Summarise counts and the worst errors, by shelf."""
    rows = []
    for shelf in ABOUT:
        of_shelf = on_shelves((r for r in records if "error" not in r), [shelf])
        if not of_shelf or shelf == APART:
            continue
        found = counts(of_shelf)
        waiting, outside = found.get("predicted", 0), found.get("outside", 0)
        answers = [answer for record in of_shelf for answer in record["references"] if answer["state"] == "passed"]
        sizes = sorted(abs(size) for size in map(share, answers) if size is not None)
        middle = _percent(sizes[len(sizes) // 2], False) if sizes else "–"
        worst = _percent(sizes[-1], False) if sizes else "–"
        asked = f"{found['references']}, {waiting} not measured" if waiting else found["references"]
        cells = (found["cases"], asked, found["passed"], found["missed"] + outside, found["failed"] + found["met"])
        rows.append([f"[{shelf}](#{shelf})", *map(str, cells), middle, worst])
    head = ("shelf", "cases", "references", "met", "known misses", "failed", "median error", "largest error")
    remark = f"{len(records)} cases; some stand on more than one shelf. Errors are those of references that are met."
    return [*_rows(head, rows), "", " ".join([remark, *_of_inference(records)])]


def _of_inference(records: Sequence[Record]) -> list[str]:
    """Count the references of kind "inference", which prove nothing."""
    found = counts(apart(records)[1])
    link = f"[arithmetic of inference](#{TITLES[APART].lower().replace(' ', '-')})"
    return [f"Not counted: {found['references']} references of {link}."] if found["references"] else []


def _table(records: Sequence[Record]) -> list[str]:
    rows = []
    for record in records:
        for number, answer in enumerate(record["references"]):
            name = f"{_link(record)}<br>{_cell(record['title'])}" if number == 0 else ""
            rows.append([name, *_answer(answer)])
    return _rows(TABLE_HEAD, rows)


def _predictions(records: Sequence[Record]) -> list[str]:
    """Format the table of blind predictions, whose bands stand apart; the day stands once for each case."""
    rows = []
    for record in records:
        days = dict.fromkeys(f"{answer['date']} with dem {answer['version']}" for answer in record["references"])
        for number, answer in enumerate(record["references"]):
            case = f"{_link(record)}<br>{_cell(record['title'])}<br>on {', '.join(days)}"
            value = f"{shown(answer['predicted'])} ({shown(answer['numerical'])})"
            middle, half = sum(answer["model"]) / 2.0, (answer["model"][1] - answer["model"][0]) / 2.0
            model = f"{_percent(middle)} ± {_percent(half, False)}"
            size = share(answer)
            measured = expected(answer) + (f"<br>{_percent(size)}" if size is not None else "")
            rows.append([
                "" if number else case, f"`{answer['quantity']}`", value, shown(answer["inputs"]), model,
                f"**{shown(answer['band'])}**", measured, VERDICTS[answer["state"]],
            ])  # fmt: skip
    return _rows(BLIND_HEAD, rows)


def _answer(answer: dict[str, Any]) -> list[str]:
    size = share(answer)
    values = (found(answer), expected(answer), off(answer))
    verdict = VERDICTS[answer["state"]]
    return [
        f"`{answer['quantity']}`",
        *map(_cell, values),
        _percent(size) if size is not None and off(answer) != "inside" else "",
        (allowed(answer) + "\\*" * bool(answer.get("reason"))).replace(" ", KEPT),
        verdict if answer["state"] == "passed" else f"**{verdict}**",
    ]


def _sources(records: Sequence[Record]) -> list[str]:
    """List the sources of the values, and the reasons of missed ones."""
    lines = ["Sources:", ""]
    for record in records:
        said = [answer["source"] for answer in record["references"] if answer["source"]]
        if said:
            lines.append(f"* {_link(record)}: {'; '.join(dict.fromkeys(map(_cell, said)))}.")
    own = [
        f"* {_link(record)}, `{answer['quantity']}`: {_cell(answer['reason'])}."
        for record in records
        for answer in record["references"]
        if answer.get("reason")
    ]
    few = [
        f"* {_link(record)}, `{answer['quantity']}`: {answer.get('specimens', 'few')} tests, standard deviation "
        f"{answer['scatter']:g}, {100.0 * answer['scatter'] / abs(answer['value']):.2g} %."
        for record in records
        for answer in record["references"]
        if answer.get("scatter")
    ]
    missed = [
        f"* {_link(record)}, `{answer['quantity']}`: {_cell(answer['missed'])}."
        for record in records
        for answer in record["references"]
        if answer["state"] == "missed"
    ]
    blind = any("predicted" in answer for record in records for answer in record["references"])
    title = "Model errors:" if blind else "\\* Tolerances of their own:"
    lists = {"Known misses:": missed, title: own, "Scatter of repeated tests:": few}
    return [*lines, "", *(line for title, those in lists.items() if those for line in (title, "", *those, ""))]


def _link(record: Record) -> str:
    path = PurePosixPath(record["case"])
    return f"[{path.parent.name}/{path.stem}]({path})"


def _cell(text: str) -> str:
    """Escape text for a cell of a table."""
    return " ".join(text.split()).replace("|", "\\|")


def _percent(value: float, signed: bool = True) -> str:
    """Format a share in per cent with two digits."""
    size = abs(100.0 * value)
    places = 0 if size >= 99.5 else 1 if size >= 9.95 else 2 if size >= 0.0995 else 3
    text = f"{100.0 * value:+.{places}f}" if signed else f"{size:.{places}f}"
    return ("0.000 %" if size < 5e-4 else f"{text} %").replace("-", "−").replace(" ", KEPT)


def _rows(head: Sequence[str], rows: Iterable[Sequence[str]]) -> list[str]:
    return ["| " + " | ".join(cells) + " |" for cells in (head, ["---"] * len(head), *rows)]
