"""Cases drawn at random: every generator in 2D and 3D, crossed with what a case may have beside it. A seed is a case.

What is drawn is sound on its face, small, and may stand, fall or be refused: walls with outlines, openings, leaves;
imperfections, loads, pressures, fill, ties, bars, head joints, joint laws, blocks that deform, ground, all analyses.
"""

from __future__ import annotations

import random
from collections.abc import Callable
from typing import Any

Tables = dict[str, Any]


class Draw(random.Random):
    """Random numbers in the forms that cases are made of; `space`: whether the case is in 3D."""

    space = False

    def size(self, low: float, high: float) -> float:
        """A number with three digits, as people write them."""
        return float(f"{self.uniform(low, high):.3g}")

    def power(self, low: float, high: float) -> float:
        """A number whose decimal logarithm lies between these."""
        return float(f"{10 ** self.uniform(low, high):.3g}")

    def some(self, share: float, **keys: Any) -> Tables:
        """These keys in that share of cases; values that are functions are called then."""
        if self.random() >= share:
            return {}
        return {key: value() if callable(value) else value for key, value in keys.items()}

    def point(self, x: float, up: float) -> list[float]:
        """A point of the elevation."""
        return [x, 0.0, up] if self.space else [x, up]

    def vector(self, size: float) -> list[float]:
        """A force or direction, more often down than up."""
        return [self.size(-size, size) for _ in range(1 + self.space)] + [self.size(-size, 0.3 * size)]


def opening(d: Draw) -> Tables:
    """A hole in a wall, with a lintel, an arch or nothing over it."""
    over = d.choice([{}, {"lintel": {"height": 0.2, "bearing": 0.15}}, {"arch": {"voussoirs": 5, "ring": 0.15}}])
    return {"x": d.size(0.3, 0.8), "y": d.choice([0.0, 0.2, 0.3]), "width": 0.4, "height": d.size(0.2, 0.5)} | over


def outline(d: Draw) -> Tables:
    """The elevation of a wall by its corners."""
    top = d.choice(
        [
            [[2.0, 1.2], [1.0, 1.6], [0.0, 1.2]],
            [[2.0, 1.4], [1.2, 1.4], [0.8, 0.6], [0.0, 0.6]],
            [[1.8, 1.3], [0.3, 1.3]],
        ]
    )
    holes = d.some(0.3, holes=[[[0.7, 0.2], [1.1, 0.2], [1.1, 0.6], [0.7, 0.6]]])
    return {"points": [[0.0, 0.0], [2.0, 0.0], *top], **holes, **d.some(0.2, lintel={"height": 0.2, "bearing": 0.15})}


def elevation(d: Draw, gable: bool = True) -> Tables:
    """What walls have in common beside their stones."""
    keys = d.some(0.3, openings=lambda: [opening(d)]) | (d.some(0.1, gable={"height": 0.5}) if gable else {})
    keys |= d.some(0.15, base_extension=0.3)
    return keys | (d.some(0.15, sides=[{"face": d.choice(["-y", "+y", "+x"])}]) if d.space else {})


def stones(d: Draw, **keys: Any) -> Tables:
    """A wall of a pattern: by its size or an outline."""
    shape = {"outline": outline(d)} if d.random() < 0.3 else {"size": [d.size(1.0, 2.2), d.size(0.7, 1.5)]}
    return (
        keys
        | shape
        | {"thickness": d.size(0.2, 0.6)}
        | elevation(d, "size" in shape)
        | d.some(0.15, quoins={"length": 0.4, "height": 0.25})
    )


def wall(d: Draw) -> Tables:
    table: Tables = {"block": [d.size(0.3, 0.7), d.size(0.2, 0.4)], "thickness": d.size(0.2, 0.6)}
    if d.random() < 0.2:
        table |= {"outline": outline(d)} | elevation(d, gable=False)
    else:
        table |= {"courses": d.randint(1, 6), "blocks_per_course": d.randint(1, 5)} | elevation(d)
        table |= d.some(0.1, ends="toothed") | d.some(0.15, first="full")
    table |= d.some(0.3, bond=d.choice(["stack", "running", "english", "flemish", "english-garden"]))
    if d.space and d.random() < 0.4:
        table |= {"leaves": d.randint(1, 3)} | d.some(0.4, through_stones=0.3) | d.some(0.2, core={"thickness": 0.15})
    return table


def column(d: Draw) -> Tables:
    table: Tables = {"block": [d.size(0.3, 0.9), d.size(0.2, 0.7)], "courses": d.randint(1, 6)}
    return (
        table | d.some(0.4, top_width=0.3) | d.some(0.4, cap={"width": 0.6, "height": 0.2}) | d.some(0.5, thickness=0.4)
    )


def arch(d: Draw) -> Tables:
    n, span = d.randint(3, 13), d.size(1.0, 3.0)
    shape = d.choice(
        [
            {"radius": d.size(0.8, 2.0), "included_angle_deg": d.size(60.0, 180.0), "voussoirs": n},
            {"shape": "segmental", "span": span, "rise": d.size(0.2, 0.45 * span), "voussoirs": n},
            {"shape": "pointed", "span": span, "rise": d.size(0.6, 0.9) * span, "voussoirs": n + n % 2},
            {"shape": "flat", "span": d.size(0.6, 1.5), "voussoirs": n},
        ]
    )
    piers = d.some(0.4, columns={"width": 0.8, "height": d.size(0.5, 1.5), "courses": d.randint(1, 3)})
    return {**shape, "ring": d.size(0.2, 0.5), **d.some(0.5, thickness=0.6), **piers}


def bridge(d: Draw) -> Tables:
    table: Tables = {"span": d.size(2.0, 4.0), "ring": d.size(0.25, 0.5), "voussoirs": d.randint(5, 9)}
    table |= d.some(0.6, height=1.0, abutments={"width": 1.5, "courses": 2})
    if "height" in table and d.random() < 0.5:
        table |= {"count": 2, "piers": {"width": 1.0}}
    table |= d.some(0.3, spandrels={"block": [0.8, 0.4], "cover": 0.2}) | d.some(0.4, rise=0.8)
    return table | (d.some(0.3, rows=2) if d.space else {})


def drums(d: Draw) -> Tables:
    table: Tables = {
        "radius": 0.45,
        "height": d.size(1.0, 4.0),
        "courses": d.randint(1, 5),
        "sides": d.choice([6, 8, 12, 24]),
    }
    return (
        table
        | d.some(0.4, top_radius=0.36)
        | d.some(0.2, entasis=0.01)
        | d.some(0.3, capital={"width": 1.1, "height": 0.2, "echinus": 0.2})
    )


def temple(d: Draw) -> Tables:
    shaft = {"radius": 0.4, "height": d.size(1.5, 3.0), "courses": d.randint(1, 3), "sides": d.choice([6, 8])}
    table: Tables = {
        "columns": d.randint(2, 3),
        "spacing": d.size(1.5, 2.5),
        "column": shaft,
        "architrave": {"height": 0.5},
    }
    return table | d.some(0.3, frieze={"height": 0.4}) | d.some(0.3, pediment={"rise": 0.6})


def vault(d: Draw) -> Tables:
    shape = d.choice(["barrel", "groin", "cloister", "dome"])
    if shape == "dome":
        table: Tables = {
            "radius": 2.0,
            "courses": d.randint(2, 4),
            "per_course": d.randint(5, 8),
            "thickness": d.size(0.2, 0.5),
        }
        return table | {"shape": shape} | d.some(0.3, oculus_deg=20.0)
    table = {
        "shape": shape,
        "span": 3.0,
        "voussoirs": d.choice([3, 5, 7]),
        "rows": d.randint(1, 2),
        "thickness": d.size(0.2, 0.5),
    }
    return (
        table
        | d.some(0.5, included_angle_deg=d.size(100.0, 180.0))
        | d.some(0.3, piers={"width": 1.0, "height": 1.0})
        | ({"length": 2.0} if shape == "barrel" else d.some(0.3, length=2.0))
    )


def building(d: Draw) -> Tables:
    x, y = d.size(1.8, 2.6), d.size(1.6, 2.4)
    plan = [
        ("s", [[0.0, 0.0], [x, 0.0]]),
        ("e", [[x, 0.0], [x, y]]),
        ("n", [[0.0, y], [x, y]]),
        ("w", [[0.0, 0.0], [0.0, y]]),
    ]
    walls = [
        {"id": name, "axis": axis} | d.some(0.3, openings=lambda: [opening(d)])
        for name, axis in plan[: d.randint(1, 4)]
    ]
    floor = {"id": "floor", "z": 0.8, "on": ["s", "n"], "kind": d.choice(["rigid", "beams"])}
    table: Tables = {"block": [0.6, 0.4], "thickness": 0.4, "courses": d.randint(2, 4), "walls": walls}
    pattern = {
        "kind": "coursed",
        "spacing": [0.4, 0.03],
        "segment": [0.8, 0.2],
        "deviation": [0.0, 0.03],
        "head_spacing": [0.6, 0.1],
    }
    return (
        table
        | (d.some(0.5, floors=[floor]) if len(walls) == 4 else {})
        | d.some(0.2, pattern=d.choice([pattern, {"kind": "voronoi", "cells": 12}]))
    )


def coursed(d: Draw) -> Tables:
    courses = {"spacing": [0.3, d.size(0.0, 0.05)], "segment": [0.8, 0.2], "deviation": [0.0, d.size(0.0, 0.04)]}
    return stones(d, **courses, head_spacing=[0.5, 0.1])


def section(d: Draw) -> Tables:
    table: Tables = {"size": [0.7, d.size(0.6, 1.5)], "course": [0.25, 0.03], "face": [0.2, 0.03]}
    return table | {"cell": 0.2, "through": d.choice([0, 2])}


STRUCTURES: dict[str, Callable[[Draw], Tables]] = {
    "wall": wall,
    "column": column,
    "arch": arch,
    "bridge": bridge,
    "voronoi-wall": lambda d: stones(d, cells=d.randint(4, 20), relax=d.choice([0, 3, 10])),
    "coursed-wall": coursed,
    "herringbone-wall": lambda d: stones(d, block=[d.choice([0.4, 0.6]), 0.2]) | d.some(0.3, bond="rows"),
    "wall-section": section,
    "drums": drums,
    "temple-front": temple,
    "vault": vault,
    "building": building,
}  # fmt: skip
IN_SPACE = ("drums", "temple-front", "vault", "building")


def joint(d: Draw) -> Tables:
    """A joint of any law, most often of friction alone."""
    friction = {"friction": d.size(0.3, 0.95)}
    bond = {"tension": d.power(3, 5), "cohesion": d.power(5.1, 5.6)}
    energies = {"fracture_energy_tension": 10.0, "fracture_energy_shear": 50.0}
    stiff = {"kn": d.power(8, 11), "ks": d.power(8, 11)}
    softening = {"residual": 0.7, "slip_start": 1e-3, "slip_length": 1e-3}
    laws: list[Tables] = [
        friction | d.some(0.5, softening=softening),
        {"law": "mohr-coulomb", **friction, "cohesion": d.power(3, 5)},
    ]
    laws += [
        {"law": "fracture", **friction, **bond, **energies},
        {"law": "crushing", **friction, "compression": d.power(5.5, 7)},
    ]
    laws += [{"law": "barton", "jrc": 8.0, "jcs": 5e7, "residual_angle_deg": 28.0}, {"law": "elastic", **stiff}]
    laws += [{"law": "slip-degrading", **friction, "residual": 0.7, "slip_scale": 0.01}]
    laws += [{"law": "rate-dependent", **friction, "friction_dynamic": 0.25, "velocity": 0.05}]
    table = friction if d.random() < 0.7 else d.choice(laws)
    profile = {"sides": d.randint(2, 4), "aperture": 1e-4} | d.some(0.3, over="face") | d.some(0.3, only="bed")
    return (
        table
        | d.some(0.25, **stiff)
        | (d.some(0.05, profile=profile))
        | d.some(0.1, points=d.choice([2, 3, 5]))
        | d.some(0.05, variation=0.1)
    )


def beside(d: Draw, kind: str) -> Tables:
    """Loads, ties, bars and the like on the structure "s" of this kind."""
    on = d.choice([{"structure": "s"}, {"block": "s-*"}, {"at": d.point(d.size(0.0, 0.5), 3.0)}])
    walls = kind in ("wall", "column")
    foot, head = (0.0, 0.0) if kind in ("column", "drums") else (d.size(0.1, 0.4), d.size(0.1, 0.9))
    ends = [d.point(foot, d.size(0.05, 0.2)), d.point(head, d.size(0.3, 0.7))]
    earth = {"density": 1800.0, "level": 0.8, "coefficient": 0.3}
    acts = d.choice([{"uniform": d.size(-500.0, 900.0)}, {"fluid": {"level": 0.6}}, {"earth": earth}])
    error = d.choice(["height", "length", "wedge", "lean", "shift"])
    spread = [0.001, 0.0] if error == "shift" else d.choice([-0.002, [-0.001, 0.001], {"deviation": 0.0003}])
    tie = {"ends": ends, "area": 1e-4, "young": 2e11} | d.some(0.3, yield_force=1e4) | d.some(0.3, prestress=200.0)
    bar = {"area": 1e-4, "young": 2e11, "bond_stiffness": 1e9} | d.some(0.5, bond_strength=4e4)
    quantity = d.choice(["displacement", "rotation", "velocity"])
    monitors = [{"structure": "s", "component": "x"}, {"block": "s-*", "quantity": quantity}]
    tables = d.some(0.35, load=[on | {"force": d.vector(1500.0)} | d.some(0.3, kind="live")])
    pressed = {"structure": "s", "face": d.choice(["+x", "-x", "top", "all"]), **acts} | d.some(0.3, kind="live")
    tables |= d.some(0.2, pressure=[pressed])
    tables |= d.some(0.08, fill=[{"structure": "s", "density": 1800.0, "level": 2.5} | d.some(0.4, coefficient=0.3)])
    held = 0.2 if kind not in ("arch", "bridge", "vault", "temple-front") else 0.03  # where there is a block to hold
    tables |= d.some(held, tie=[tie | d.some(0.1, anchored=True)])
    tables |= d.some(
        0.6 * held, bars={"b": bar | d.some(0.3, yield_stress=4e8)}, reinforcement=[{"bar": "b", "path": ends}]
    )
    tables |= d.some(0.4 if walls else 0.02, imperfection=[{error: spread} | d.some(0.3, restack=False)])
    tables |= d.some(0.1, restraint=[{"structure": "s", "fixed": [d.choice(["x", "rotation"])]}]) | d.some(
        0.1, ground={}
    )
    return tables | d.some(0.3, monitor=monitors[: d.randint(1, 2)]) | d.some(0.4, output={"frames": d.choice([0, 3])})


def analysis(d: Draw) -> Tables:
    """What is computed, with the motion, damping and supports that belong to it."""
    kind = d.choice(["pushover"] * 6 + ["gravity", "cycle", "safety", "modes", "settlement"] + ["time-history"] * 3)
    table: Tables = {"kind": kind} | (
        d.some(0.3, kinematics=d.choice(["fixed", "large", "large"])) if kind != "time-history" else {}
    )
    tables: Tables = {"analysis": table}
    if kind in ("pushover", "cycle", "safety"):
        sideways = [d.choice([1.0, -1.0]), *([d.choice([0.0, 1.0])] if d.space else []), d.choice([0.0, 0.0, 0.2])]
        table |= {"direction": sideways} | d.some(0.35, pattern=d.choice(["tilt", "live"]))
    if kind in ("pushover", "safety"):
        table |= (
            {"resolution": d.choice([0.01, 0.05])} | d.some(0.3, follow=d.size(0.01, 0.1)) | d.some(0.2, limit=True)
        )
    if kind == "pushover":
        table |= d.some(0.1, control="displacement", follow=0.02, increments=10)
    elif kind == "cycle":
        table |= {"path": [0.03, -0.03, 0.0], "step": 0.015}
    elif kind == "settlement":
        tables["settlement"] = [{"block": "s-base*", "displacement": [0.001, *([0.0] if d.space else []), -0.001]}]
    elif kind == "time-history":
        strength = {"amplitude": d.size(0.5, 8.0), "frequency": d.size(2.0, 8.0)}
        motion = d.choice(
            [{"kind": "pulse", "shape": d.choice(["sine", "cosine", "ricker"])}, {"kind": "harmonic", "cycles": 1.0}]
        )
        dampings: list[Tables] = [
            {"restitution": "housner"},
            {"mass": 0.5},
            {"local": 0.3},
            {"stiffness": 1e-5},
            {"none": True},
        ]
        table |= {"duration": d.size(0.03, 0.2), "coda": 0.0} | d.some(0.1, settle=False) | d.some(0.05, repeats=2)
        tables |= {"motion": [motion | strength] if d.random() < 0.9 else [{"kind": "none"}]} | d.some(
            0.5, damping=d.choice(dampings)
        )
        tables |= d.some(0.2, initial=[{"structure": "s", "velocity": [0.1, *([0.0] * (4 if d.space else 1)), 0.0]}])
    return tables


def case(seed: str) -> Tables:
    """The tables of a case."""
    d = Draw(seed)
    d.space = d.random() < 0.4
    kind = d.choice([kind for kind in STRUCTURES if d.space or kind not in IN_SPACE])
    structure = (
        {"kind": kind, "id": "s", "material": "stone"}
        | STRUCTURES[kind](d)
        | d.some(0.04, crack="bond")
        | d.some(0.1, rotation_deg=d.size(-5.0, 30.0))
    )
    stone = {"density": d.size(1500.0, 2800.0)} | d.some(
        0.08, young=d.power(9, 10.5), deformation=d.choice(["joints", "uniform-strain"])
    )
    joints = {"dry": joint(d)}
    bond = {
        "law": "fracture",
        "friction": 0.7,
        "tension": 1e5,
        "cohesion": 2e5,
        "fracture_energy_tension": 10.0,
        "fracture_energy_shear": 50.0,
    }
    joints |= {"bond": bond} if "crack" in structure else {}
    if d.random() < 0.15:
        joints["dry"]["head"] = d.choice(["none", "head"])
        joints |= {"head": {"friction": 0.4}} if joints["dry"]["head"] == "head" else {}
    head: Tables = {"title": seed, "seed": d.randrange(1000)} | ({"dimension": 3} if d.space else {})
    asked, more = analysis(d), beside(d, kind)
    if asked["analysis"].get("pattern") == "live" and d.random() < 0.95:
        more["load"] = [*more.get("load", []), {"structure": "s", "force": d.vector(1500.0), "kind": "live"}]
    return head | {"materials": {"stone": stone}, "joints": joints, "structure": [structure]} | more | asked
