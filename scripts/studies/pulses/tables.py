"""Tables of pulses.md: published results and ours."""

from __future__ import annotations

from collections.abc import Mapping, Sequence
from typing import Any

import numpy as np
from bench.table import percent
from reference import result, value

from studies.pulses import column
from studies.pulses.pictures import BOOK, NAMES, VAULT_BOOK
from studies.template import bracket
from studies.template import table as markdown

Row = Mapping[str, Any]
SIDES = {-1: "−", 1: "+"}
THEIR_FREE = {"elastic_s5": (11.08, 0.0505), "elastic_mx5": (12.57, 0.0520)}  # [Hz], -: read from their series


def values(table: Mapping[str, Any]) -> dict[str, Any]:
    """Return the values that page.md.j2 shows of pulses.json."""
    vault, ranges = table["vault"], _again(table["column"])
    case = vault["variants"][0]
    return {
        "static": _static(table),
        "lasts": column.LASTS, "margin": column.MARGIN, "domain": _domain(table),
        "ranges": ranges, "first": ranges[0][0] if ranges else "", "last": ranges[-1][0] if ranges else "",
        "again": markdown(("tp [s]", "falls at amplitudes of the grid [g]", "tried up to"), ranges),
        "fine": column.FINE, "coarse": column.MARGIN, "finer": _fine(table["fine"]),
        "buttresses": _buttresses(table["buttresses"]["rows"]),
        "their_f": THEIR_FREE["elastic_s5"][0], "their_r": 100 * THEIR_FREE["elastic_s5"][1],
        "our_f": case["frequencies"][0], "pressed": vault["pressed"][0],
        "peaks": _peaks(case), "steps": _steps(table["steps"]), "variants": _variants(vault["variants"]),
        "edges": _edges(table["edges"]), "elements": _elements(vault["elements"]), "free": _free(table["free"]),
        "count": len(table["spread"]["eq10_s5"]), "spread": _spread(table["spread"]),
    }  # fmt: skip


def _steps(rows: Sequence[Row]) -> dict[str, str]:
    """Ranges of peaks and times over the time steps tried."""

    def span(values: list[float], factor: float, places: int) -> str:
        low, high = sorted((factor * min(values), factor * max(values)), key=abs)
        return f"{low:.{places}f} to {high:.{places}f}"

    return {
        "margins": span([row["margin"] for row in rows], 1.0, 2),
        "first": span([row["values"][0] for row in rows], 1e3, 3),
        "second": span([row["values"][1] for row in rows], 1e3, 2),
        "time": span([row["times"][1] for row in rows], 1.0, 3),
    }


def _static(table: Row) -> str:
    rows = []
    for name, found, theirs in (
        ("column", table["column_static"], value(BOOK, "col_static")),
        ("arch on buttresses", table["buttresses"]["static"], value(BOOK, "arch_static")),
        ("arch of 17 voussoirs", table["vault"]["static"], value(VAULT_BOOK, "static")),
        ("the same, kn = ks = 1e12 Pa/m", table["stiff_static"], value(VAULT_BOOK, "static")),
    ):
        exact = found["limit"]["associated"]
        error = percent(0.5 * sum(found["bracket"]) / theirs - 1.0)
        rows.append((name, f"{theirs:.4f}", bracket(found["bracket"]), error, f"{exact:.4f}"))
    return markdown(("structure", "data book", "bracket", "error", "limit analysis, associated"), rows)


def _domain(table: Row) -> str:
    udec, lmgc = (dict(zip(book["tp_s"], book["value"])) for book in _series())
    others = {name: {row["tp"]: row for row in rows} for name, rows in table["others"].items()}
    rigid = {row["tp"]: row["least"] for row in table["rigid"]}
    rows = []
    for row in table["column"]:
        tp, least = row["tp"], row["least"]
        cells = [f"{tp:g}", _bound(row)]
        cells += [f"{book[tp]:g} ({percent(least / book[tp] - 1.0)})" if tp in book else "" for book in (udec, lmgc)]
        cells += [_bound(rows_of[tp]) if tp in rows_of else "" for rows_of in others.values()]
        rows.append([*cells, f"{rigid[tp]:.3f}" if rigid[tp] else "none"])
    head = ("tp [s]", f"dem, {column.MAIN} [g], side", "UDEC", "LMGC90", *(f"dem, {name}" for name in others), "rigid")
    return markdown(head, rows)


def _series() -> tuple[Row, Row]:
    return result(BOOK, "col_domain_udec"), result(BOOK, "col_domain_lmgc")


def _bound(row: Row) -> str:
    fall = row["fall"]
    return f"{row['least']:.3f}, {SIDES[fall['side']]}" if fall["collapsed"] else f"{row['least']:.3f}"


def _again(rows: Sequence[Row]) -> list[tuple[str, str, str]]:
    """Where a structure stands again: tp, the amplitudes of the grid at which it falls, the highest one tried [g]."""
    found = []
    for row in rows:
        stretches: list[list[float]] = []
        for k, (amplitude, falls) in enumerate(row["answers"]):
            if falls and k and row["answers"][k - 1][1]:
                stretches[-1].append(amplitude)
            elif falls:
                stretches.append([amplitude])
        if len(stretches) > 1:
            said = [f"{one[0]:.3f}" + (f" … {one[-1]:.3f}" if len(one) > 1 else "") for one in stretches]
            found.append((f"{row['tp']:g}", "; ".join(said), f"{row['answers'][-1][0]:.3f}"))
    return found


def _fine(rows: Sequence[Row]) -> str:
    head = ("tp [s]", f"least at {column.MARGIN:g} [g]", f"at {column.FINE:g} [g]", "difference")
    cells = [
        (f"{r['tp']:g}", f"{r['coarse']:.4f}", f"{r['fine']:.4f}", percent(r["fine"] / r["coarse"] - 1.0)) if r["fine"]
        else (f"{r['tp']:g}", f"{r['coarse']:.4f}", "elsewhere", "more than 4 %")
        for r in rows
    ]  # fmt: skip
    return markdown(head, cells)


def _buttresses(rows: Sequence[Row]) -> str:
    names = list(dict.fromkeys(row["damping"] for row in rows))
    found = {(row["damping"], row["tp"]): row["least"] for row in rows}
    cells = [
        [f"{tp:g}", *(f"{found[name, tp]:.3f}" if found[name, tp] else "none up to 8" for name in names)]
        for tp in dict.fromkeys(row["tp"] for row in rows)
    ]
    return markdown(("tp [s]", *(f"least amplitude, {name} [g]" for name in names)), cells)


def _peaks(case: Row) -> str:
    rows = []
    for name, title in NAMES.items():
        book = result(VAULT_BOOK, f"pulse_{name}")
        theirs, at = np.atleast_1d(book["value"]), np.atleast_1d(book["time_s"])
        for k in range(len(theirs)):
            ours, when = case[name]["values"][k], case[name]["times"][k]
            rows.append((
                title if k == 0 else "– to the other side", f"{1e3 * theirs[k]:.4f} mm, {at[k]:.4f} s",
                f"{1e3 * ours:.4f} mm, {when:.4f} s", percent(ours / theirs[k] - 1.0), percent(when / at[k] - 1.0),
            ))  # fmt: skip
    return markdown(("run", "3DEC", "dem", "error of the peak", "of its time"), rows)


def _variants(rows: Sequence[Row]) -> str:
    first = rows[0]
    cells = []
    for row in rows:
        said = []
        for name in NAMES:
            ours = row[name]["values"][0]
            change = "" if row is first else f" ({percent(ours / first[name]['values'][0] - 1.0)})"
            said.append("falls" if ours > 0.1 else f"{1e3 * ours:.3f}{change}")
        cells.append([row["group"] or "the case", row["label"], f"{row['frequencies'][0]:.2f}", *said])
    return markdown(("what", "how", "Hz", *NAMES.values()), cells)


def _edges(rows: Sequence[Row]) -> str:
    stiffnesses = list(dict.fromkeys(row["kn"] for row in rows))
    found = {(row["label"], row["kn"]): row["peak"] for row in rows}
    cells = [
        [label, *("falls" if found[label, kn] > 0.1 else f"{1e3 * found[label, kn]:.2f}" for kn in stiffnesses)]
        for label in dict.fromkeys(row["label"] for row in rows)
    ]
    return markdown(("points across the ring", *(f"kn = ks = {kn:.0e} Pa/m" for kn in stiffnesses)), cells)


def _elements(rows: Sequence[Sequence[float]]) -> str:
    head = ("mode on the springs alone", "damping ratio", "frequency", "higher by")
    return markdown(head, [(f"{f:g} Hz", f"{100 * r:.2f} %", f"{g:.3f} Hz", percent(g / f - 1.0)) for f, r, g in rows])


def _free(found: Mapping[str, Row]) -> str:
    rows = []
    for name in ("elastic_s5", "elastic_mx5"):
        (frequency, ratio), ours = THEIR_FREE[name], found[name]
        rows.append((
            NAMES[name], f"{frequency:.2f} Hz, {100 * ratio:.2f} %",
            f"{ours['frequency']:.2f} Hz, {100 * ours['ratio']:.2f} %", percent(ours["frequency"] / frequency - 1.0),
        ))  # fmt: skip
    ratios = [f"{theirs:.3f}" for theirs in (
        THEIR_FREE["elastic_mx5"][0] / THEIR_FREE["elastic_s5"][0],
        found["elastic_mx5"]["frequency"] / found["elastic_s5"]["frequency"],
    )]  # fmt: skip
    rows.append(("frequency, Maxwell over stiffness", *ratios, ""))
    return markdown(("run", "3DEC", "dem", "error of the frequency"), rows)


def _spread(found: Mapping[str, Sequence[float | None]]) -> str:
    rows = []
    for name, peaks in found.items():
        stood = 1e3 * np.array([p for p in peaks if p is not None])
        theirs = 1e3 * value(VAULT_BOOK, name)
        below = int((stood < theirs).sum())
        rows.append((
            name, f"{theirs:.2f}", f"{np.median(stood):.2f}", f"{stood.min():.2f} to {stood.max():.2f}",
            f"{below} of {len(stood)}", str(len(peaks) - len(stood)),
        ))  # fmt: skip
    return markdown(("run", "3DEC", "our median", "range", "records below theirs", "fell"), rows)
