"""The family of arches with the static load of the thesis: which included angles and rings have its other outcomes."""

from __future__ import annotations

from collections.abc import Mapping
from pathlib import Path
from typing import Any

from bench.table import percent
from reference import results
from scipy.optimize import brentq

from dem_cli.app import api
from dem_cli.core.engine.properties import joint_properties, law_of
from dem_cli.core.limit.analysis import limit_loads
from dem_cli.masonry.assembly.solver_request import solver_request
from dem_cli.results.post import style
from studies.chapter6.arch import FALLS, HEADS, TRIED, as_thesis, four, load_of, perturbed, sizes, sliding
from studies.chapter6.shaken_case import draw_blocks, run
from studies.places import CASES
from studies.solution import from_file
from studies.template import commands, table

ANGLES = tuple(range(90, 181, 10))  # deg
RINGS = (0.06, 0.08, 0.10, 0.12)  # m
RADII = (0.12, 0.45)  # m: where the radius of the load is looked for
LOAD = 0.325  # of the thesis
CASE = {(120, 0.10): 0.2293}  # that of the cases, from the data book
REPEATS = 5
KEPT = ("command", "status", "collapsed", "collapse_time", "crown", "seconds")


def measure() -> list[dict[str, Any]]:
    """Every arch with the load: static answer, its shape, four motions; where all are as the thesis, perturbed."""
    return [_member(angle, ring, radius) for angle in ANGLES for ring in RINGS
            if (radius := radius_of(angle, ring)) is not None]  # fmt: skip


def radius_of(angle: int, ring: float) -> float | None:
    """Inner radius [m] with which limit analysis gives the load of the thesis; None where no radius does."""

    def above(radius: float) -> float:
        return limit(*sizes(angle, ring, radius)) - LOAD

    if (angle, ring) in CASE:
        return CASE[angle, ring]
    return round(float(brentq(above, *RADII, xtol=1e-5)), 4) if above(RADII[0]) > 0.0 > above(RADII[1]) else None


def limit(*more: str) -> float:
    """Failure load by limit analysis, joints that dilate as they slide."""
    loaded = from_file(CASES / "validation" / "arch_8_static.toml", *more)
    model = api.build_model(loaded)
    found = limit_loads(
        model,
        joint_properties(solver_request(loaded.case), model),
        law_of(solver_request(loaded.case)),
        associated_only=True,
    )
    return found.associated.multiplier


def _member(angle: float, ring: float, radius: float) -> dict[str, Any]:
    more = sizes(angle, ring, radius)
    static = run("arch_8_static", *more)
    motions = {name: {key: one.get(key) for key in KEPT} for name, one in four(*more).items()}
    found = {"angle": angle, "ring": ring, "radius": radius, "shape": static.frames[0]["blocks"][2:],
             "static": static.answer, "motions": motions}  # fmt: skip
    if met(motions) == len(TRIED):
        found["perturbed"] = {name: _collapsed(perturbed(name, *more, repeats=REPEATS)) for name in TRIED}
    return found


def _collapsed(answer: Mapping[str, Any]) -> dict[str, int]:
    return {key: answer["repeats"][key] for key in ("runs", "collapsed")}


def met(motions: Mapping[str, Any]) -> int:
    """How many outcomes are those of the thesis."""
    return sum(as_thesis(*one) for one in motions.items())


def one_slides(member: Mapping[str, Any]) -> bool:
    """Whether the mechanism under static load has one sliding joint."""
    return bool(member["static"]["mechanism"].get("sliding_joints", {}).get("count") == 1)


def slopes(angle: float) -> tuple[float, float]:
    """Of the springing and of the joint beside it, against the horizontal [deg]."""
    springing = 90.0 - angle / 2.0
    return springing, springing + angle / 6.0


def values(found: list[dict[str, Any]]) -> dict[str, Any]:
    """What family.md.j2 shows."""
    rows = [
        (f"{one['angle']}°", f"{one['ring']:.2f}", f"{one['radius']:.4f}",
         " and ".join(f"{slope:.0f}°" for slope in slopes(one["angle"])), f"{load_of(one['static']):.4f}",
         sliding(one["static"]), *(_short(*motion) for motion in one["motions"].items()), _of_four(one))
        for one in found
    ]  # fmt: skip
    head = ("angle", "ring [m]", "inner radius [m]", "lowest joints slope", "λ", "slides", *HEADS, "as the thesis")
    thesis = results("thesis_arch_shaking")["static_exp_num"]["value"]
    worst = max((load_of(one["static"]) / thesis - 1.0 for one in found), key=abs)
    both = [f"{one['angle']}° with {one['ring']:.2f} m" for one in found
            if one_slides(one) and met(one["motions"]) == len(TRIED)]  # fmt: skip
    flat, round_ = [[one for one in found if (one["angle"] <= 150) is low] for low in (True, False)]
    return {
        "family": table(head, rows), "n": len(found), "repeats": REPEATS, "worst": percent(abs(worst)).lstrip("+"),
        "flat": _share(flat), "round": _share(round_), "one": sum(map(one_slides, found)),
        "both": len(both), "names": ", ".join(both),
        "commands": commands(found[0]["static"], found[0]["motions"][FALLS], more=5 * len(found) - 2),
    }  # fmt: skip


def _short(name: str, answer: Mapping[str, Any]) -> str:
    text = f"{answer['collapse_time']:.1f} s" if answer["collapsed"] else "stands"
    return text if as_thesis(name, dict(answer)) else f"**{text}**"


def _of_four(one: Mapping[str, Any]) -> str:
    if "perturbed" not in one:
        return f"{met(one['motions'])} of {len(TRIED)}"
    agreed = runs = 0
    for name, found in one["perturbed"].items():
        n, fell = found["runs"], found["collapsed"]
        agreed, runs = agreed + (fell if name == FALLS else n - fell), runs + n
    return f"**all**; perturbed {agreed} of {runs}"


def _share(members: list[dict[str, Any]]) -> tuple[int, int]:
    return sum(met(one["motions"]) == len(TRIED) for one in members), len(members)


def draw(found: list[dict[str, Any]], path: Path) -> None:
    """Every arch, coloured by how many of the four outcomes are those of the thesis."""
    colours = (style.COLLAPSE, style.COLLAPSE, style.STATE_COLOURS["sliding"], style.GREY, style.THRUST)
    with style.figure(path, figsize=(14.0, 6.4)) as figure:
        axes = figure.subplots(len(RINGS), len(ANGLES))
        for axis in axes.flat:
            axis.axis("off")
        for one in found:
            axis = axes[RINGS.index(one["ring"]), ANGLES.index(one["angle"])]
            n = met(one["motions"])
            draw_blocks(axis, one["shape"], f"{one['angle']}°, {one['ring']:.2f} m\n{n} of 4", edge=colours[n])
            axis.set(xlim=(-0.42, 0.42), ylim=(0.0, 0.64))


PICTURES = {"family": draw}
