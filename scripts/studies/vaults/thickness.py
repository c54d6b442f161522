"""Least thickness of a hemisphere: lunes side by side and stones in bond, against limit analysis of a lune."""

from __future__ import annotations

from pathlib import Path
from typing import Any

from oracle.lune import FacetedDome, least_thickness

from dem_cli.results.post import style
from studies.template import table
from studies.vaults.runs import dome, smoothest, thinnest

FINENESS = ((6, 12), (12, 12), (24, 24), (48, 48), (100, 100))  # courses, lunes
LUNES = (0.21, 0.22, 0.24, 0.3, 0.5, 0.7)  # friction
COURSES, STONES = 12, 12
BONDED_STONES, BONDED_FACETS = 24, 48  # in each of 12 courses
BONDED_THICKNESSES = (0.01, 0.03)


def measure() -> dict[str, Any]:
    """Least thickness over mean radius."""
    fine = [
        {"courses": courses, "lunes": lunes, "least": round(least_thickness(FacetedDome(courses, lunes, 0.7)), 6)}
        for courses, lunes in FINENESS
    ]
    lunes = []
    for friction in LUNES:
        exact = least_thickness(FacetedDome(COURSES, STONES, friction))
        found = thinnest(dome(COURSES, STONES, bond="stack"), friction, (0.7 * exact, 1.4 * exact), 0.002)
        lunes.append(found | {"exact": round(exact, 6)})
    bonded = [
        {"bond": bond, "thickness": thickness} | smoothest(stones_of(bond, thickness))
        for thickness in BONDED_THICKNESSES
        for bond in ("stack", "running")
    ]
    return {"fine": fine, "lunes": lunes, "bonded": bonded}


def stones_of(bond: str, thickness: float) -> dict[str, Any]:
    """A dome of the same stones in either bond."""
    return dome(COURSES, BONDED_STONES, bond=bond, facets=BONDED_FACETS, thickness=thickness)


def between(row: dict[str, Any]) -> str:
    """What stands and what falls."""
    stands, fails = row["between"]
    return f"{stands:.4f}, {fails:.4f}" if stands and fails else row["status"]


def values(found: dict[str, Any]) -> dict[str, str]:
    """Tables of the page."""
    return {
        "fine": table(
            ["courses", "lunes", "least t/R"],
            [[f"{row['courses']}", f"{row['lunes']}", f"{row['least']:.5f}"] for row in found["fine"]],
        ),
        "lunes": table(
            ["friction", "lune", "dem: stands, falls"],
            [[f"{row['friction']:g}", f"{row['exact']:.5f}", between(row)] for row in found["lunes"]],
        ),
        "bonded": table(
            ["t/R", "bond", "least friction: stands, falls"],
            [[f"{row['thickness']:g}", row["bond"], between(row)] for row in found["bonded"]],
        ),
    }


def draw(found: dict[str, Any], path: Path) -> None:
    """Least thickness against friction."""
    with style.figure(path, figsize=(6.4, 4.2)) as figure:
        axis = figure.subplots()
        rows = found["lunes"]
        axis.plot(
            [r["friction"] for r in rows], [r["exact"] for r in rows], color=style.GREY, label="lune, linear program"
        )
        stood = [(row["friction"], row["between"][0]) for row in rows if row["between"][0]]
        axis.plot(*zip(*stood, strict=True), "o", color=style.COLLAPSE, label="dem, heads above heads")
        axis.axhline(0.042, color=style.GREY, lw=0.8, ls=":")
        axis.text(0.7, 0.0425, "Heyman 0.042", ha="right", va="bottom", fontsize=8)
        axis.set(xlabel="friction", ylabel="least thickness / mean radius", ylim=(0.0, None))
        axis.legend(loc="upper right")


PICTURES = {"thickness": draw}
