"""docs/seeds.md: every printed result of the thesis and the two papers, what dem says of it, and how many there are."""

from __future__ import annotations

from collections import Counter
from collections.abc import Sequence
from typing import Any

from reference import book

from dem_cli.app.verify.verdict_words import off, share, shown
from dem_cli.results.output.reference import error
from studies.seeds.rows import INPUT, MET, MISSED, NOT, REPEAT, UNKNOWN, SeedRow, rows
from studies.template import filled, minus, table

SEEDS = {"000": "thesis", "001": "paper 1 (Lemos 2019)", "002": "paper 2 (Bui and Limam)"}
HEAD = ("result", "printed in", "printed", "dem", "error", "allowed", "verdict", "from, and remark")
KEPT = "\N{NO-BREAK SPACE}"
DIGITS = 4


def text() -> str:
    """The page as it should be."""
    found = rows()
    books = list(dict.fromkeys(row.book for row in found))
    parts = [(book(name)["title"], name, _table([row for row in found if row.book == name])) for name in books]
    return filled("seeds/page.md.j2", summary=_summary(found), reasons=_reasons(found), kinds=_kinds(found),
                  parts=parts, said=sentence(found))  # fmt: skip


def sentence(found: Sequence[SeedRow] | None = None) -> str:
    """How many printed results there are, and what became of them."""
    found = rows() if found is None else found
    count = Counter(row.verdict for row in found)
    compared = count[MET] + count[MISSED]
    pending = f"; {count[UNKNOWN]} not run yet" if count[UNKNOWN] else ""
    return (
        f"The thesis and the two papers print {len(found)} results; {count[REPEAT]} repeat others: {compared} are "
        "compared with what dem computes, "
        f"{count[MET]} of them met within the rule and {count[MISSED]} missed, each with what is known of the cause; "
        f"{count[INPUT]} are inputs of cases, or numbers that inputs were inferred from or chosen by; {count[NOT]} are "
        f"not computed{pending}."
    )


def _summary(found: Sequence[SeedRow]) -> str:
    """A row for each seed."""
    lines = []
    for seed, name in [*SEEDS.items(), ("", "all")]:
        count = Counter(row.verdict for row in found if seed in ("", book(row.book)["source"]["seed"]))
        cells = (
            count.total(),
            count[MET] + count[MISSED],
            count[MET],
            count[MISSED],
            count[INPUT],
            count[REPEAT],
            count[NOT],
        )
        lines.append((name, *map(str, cells), *([str(count[UNKNOWN])] if _pending(found) else [])))
    head = ("seed", "results", "compared", MET, MISSED, "inputs", REPEAT, NOT)
    return table((*head, *([UNKNOWN] if _pending(found) else [])), lines)


def _pending(found: Sequence[SeedRow]) -> bool:
    return any(row.verdict == UNKNOWN for row in found)


def _kinds(found: Sequence[SeedRow]) -> str:
    """What is compared, by where the number comes from."""
    names = {"exact": "closed form or limit analysis, as printed", "code": "DEM of the author", "experiment": "test"}
    lines = []
    for kind, name in names.items():
        count = Counter(row.verdict for row in found if row.kind == kind)
        lines.append((name, *(str(n) for n in (count[MET] + count[MISSED], count[MET], count[MISSED]))))
    return table(("number of the seed", "compared", MET, MISSED), lines)


def _reasons(found: Sequence[SeedRow]) -> str:
    """Why results are not computed."""
    words = {
        "3D": "needs a third dimension", "deformable": "needs blocks that deform",
        "lost": "an input is lost, with a figure or by damage of the text", "words": "a description or a drawing",
        "statement": "about the author's program or formulas", "not yet": "dem has no such quantity, or no such case",
    }  # fmt: skip
    count = Counter(row.why.partition(":")[0] for row in found if row.verdict == NOT)
    return table(("why not computed", "results"), [(words[word], str(number)) for word, number in count.most_common()])


def _table(those: Sequence[SeedRow]) -> str:
    return table(HEAD, [_cells(row) for row in those])


def _cells(row: SeedRow) -> tuple[str, ...]:
    name = row.page.rpartition("/")[2].rpartition(".")[0]
    remark = row.why.partition(": ")[2] if row.verdict == NOT else row.why
    link = f"[{name}]({row.page})" if name else ""
    allowed = minus(f"± {row.allowed:.2g}") if row.allowed and row.verdict in (MET, MISSED) else ""
    return (
        f"`{row.name}`<br>{row.what}", f"{row.where}; {row.kind}", _shown(row.printed), _shown(row.found),
        _error(row).replace(" ", KEPT), allowed.replace(" ", KEPT),
        f"**{row.verdict}**" if row.verdict == MISSED else row.verdict, ": ".join(filter(None, (link, remark))),
    )  # fmt: skip


def _shown(value: Any) -> str:
    if isinstance(value, list) and (len(value) != 2 or isinstance(value[0], int)):
        return ", ".join(_shown(one) for one in value)
    return "" if value is None else shown(value, DIGITS)


def _error(row: SeedRow) -> str:
    """Over the printed number, in per cent."""
    if row.verdict not in (MET, MISSED) or isinstance(row.found, (bool, str, list)) or row.found is None:
        return ""
    answer = {"value": row.compared, "found": row.found, "error": error(row.found, row.compared)}
    part = share(answer)
    return "inside" if off(answer) == "inside" else "" if part is None else minus(f"{100.0 * part:+.2g} %")
