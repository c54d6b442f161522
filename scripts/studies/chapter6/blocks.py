"""Free rocking of single blocks: what an impact leaves, for four slendernesses and four dampings (thesis 6.1)."""

from __future__ import annotations

import math
from pathlib import Path
from typing import Any

import numpy as np
from bench.diagrams import COLOURS, MARKERS
from bench.table import percent
from reference import results

from dem_cli.results.post import style
from studies.chapter6.shaken_case import extremes, run
from studies.polygons import rectangle
from studies.storage import rounded
from studies.template import commands, table

FRACTIONS = (0.15, 0.35, 0.45, 0.75)
HEIGHT = 0.3  # [m], assumed
LEAST = 0.05  # of the angle at which the block falls: swings that count
TILT = 0.5  # of the same
SPECIMENS = ("S1", "S2", "S3")  # granite blocks of the LNEC


def measure() -> dict[str, Any]:
    """Ratios of all blocks and dampings."""
    shapes = [row["aspect"] for row in _housner().values()]
    rows = [_ratios(aspect, zeta) for aspect in shapes for zeta in FRACTIONS]
    others = [
        {"id": name} | _ratios(1.0 / math.tan(results("pena_rocking")[f"{name}_alpha"]["value"]), 0.35, height=1.0)
        for name in SPECIMENS
    ]
    return {"rows": rows, "granite": others}


def _housner() -> dict[str, dict[str, Any]]:
    return {name: row for name, row in results("thesis_rocking").items() if name.startswith("r_")}


def _ratios(aspect: float, fraction: float, height: float = HEIGHT) -> dict[str, Any]:
    """Energy after over before each impact. aspect: h/b."""
    half, alpha = 0.5 * height / aspect, math.atan(1.0 / aspect)
    corners = rectangle(-half, 0.0, half, height)
    stiffness = 0.01 * 55e9 / height
    found = run(
        "column_marble_rocking",
        f"block.1.vertices={[[round(x, 6) for x in corner] for corner in corners]}",
        f"damping.contact_fraction={fraction:g}",
        f"initial.0.tilt={TILT * alpha:.5f}",
        f"joints.dry.kn={stiffness:.4g}",
        f"joints.dry.ks={stiffness:.4g}",
        f"analysis.duration={2.5 if height < 0.5 else 12.0:g}",
    )
    swings = np.concatenate([[TILT * alpha], extremes(found.times, found.values[:, 0])[1]])
    swings = swings[: 1 + int(np.argmax(np.append(swings, 0.0) < LEAST * alpha))]
    heights = np.cos(alpha - swings) - math.cos(alpha)
    each = (heights[1:] / heights[:-1])[: max(len(swings) - 2, 1)]
    means = {"each": rounded(each), "mean": rounded(each.mean())}
    return {"aspect": aspect, "fraction": fraction, **means, "run": found.answer}


def means_of(found: dict[str, Any]) -> dict[tuple[float, float], float]:
    """Mean ratio of energy of each h/b and ζ."""
    return {(row["aspect"], row["fraction"]): row["mean"] for row in found["rows"]}


def worst(found: dict[str, Any], fraction: float) -> tuple[float, float]:
    """Largest error over Housner at one ζ, of energy and of velocity."""
    ratios = [means_of(found)[row["aspect"], fraction] / row["value"] for row in _housner().values()]
    return max((r - 1.0 for r in ratios), key=abs), max((math.sqrt(r) - 1.0 for r in ratios), key=abs)


def values(found: dict[str, Any]) -> dict[str, Any]:
    """What blocks.md.j2 shows."""
    means, pena = means_of(found), results("pena_rocking")
    rows = []
    for row in _housner().values():
        rigid, ours = row["value"], [means[row["aspect"], z] for z in FRACTIONS]
        rows.append([f"{row['aspect']:g}", f"{rigid:.3f}", *(f"{r:.3f} ({percent(r / rigid - 1.0)})" for r in ours)])
    rows.append(["largest error: energy", ""] + [percent(worst(found, z)[0]) for z in FRACTIONS])
    rows.append(["of velocity", ""] + [percent(worst(found, z)[1]) for z in FRACTIONS])
    granite, off = [], []
    for row in found["granite"]:
        measured, rigid = pena[f"{row['id']}_e_exp"]["value"], pena[f"{row['id']}_e"]["value"]
        ours = math.sqrt(row["mean"])
        off.append((abs(ours / measured - 1.0), abs(rigid / measured - 1.0)))
        granite.append((row["id"], f"{row['aspect']:.2f}", f"{measured:.3f}", f"{rigid:.3f}", f"{ours:.3f}",
                        percent(ours / measured - 1.0)))  # fmt: skip
    energy, velocity = (percent(error) for error in worst(found, 0.35))
    return {
        "ratios": table(("h/b", "Housner", *(f"ζ = {z:g}" for z in FRACTIONS)), rows),
        "granite": table(("granite", "h/b", "measured, velocity", "Housner", "dem, ζ = 0.35", "error"), granite),
        "commands": commands(found["rows"][0]["run"], more=len(found["rows"]) + len(granite) - 1),
        "least": LEAST, "energy": energy, "velocity": velocity,
        "pena": percent(max(a for a, _ in off)).lstrip("+"),
        "pena_housner": percent(max(b for _, b in off)).lstrip("+"),
    }  # fmt: skip


def draw(found: dict[str, Any], path: Path) -> None:
    """Ratios over slenderness."""
    means, aspects = means_of(found), [row["aspect"] for row in _housner().values()]
    smooth = np.linspace(1.8, 5.2, 100)
    with style.figure(path, figsize=(6.4, 4.0)) as figure:
        axis = figure.subplots()
        rigid = (1.0 - 1.5 / (1.0 + smooth**2)) ** 2
        axis.plot(smooth, rigid, color=style.INK, lw=1.4, label="Housner")
        for i, z in enumerate(FRACTIONS):
            axis.plot(aspects, [means[a, z] for a in aspects], MARKERS[i], color=COLOURS[i], ms=6, label=f"ζ = {z:g}")
        for name, marker in (("col_r_dem", "s"), ("col_r_exp", "*")):
            row = results("thesis_arch_shaking")[name]
            label = f"column of 6.2, {'thesis DEM' if marker == 's' else 'measured'}"
            axis.plot(2.0, row["value"], marker, ms=10, mfc="none", color=style.REFERENCE, label=label)
        axis.set(xlabel="h/b", ylabel="ratio of energy after to before an impact", ylim=(0.4, 1.0))
        axis.legend(loc="lower right")


PICTURES = {"blocks": draw}
