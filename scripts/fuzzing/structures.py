"""Structures drawn at random: every generator of dem, small, with outlines, openings, leaves and what else it takes."""

from __future__ import annotations

from collections.abc import Callable
from typing import Any

from fuzzing.draw import Draw, Tables


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
    shape = {"outline": outline(d)} if d.random() < 0.3 else {"size": [d.size(0.9, 1.6), d.size(0.6, 1.2)]}
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
        table |= {"courses": d.randint(1, 5), "blocks_per_course": d.randint(1, 4)} | elevation(d)
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
    table: Tables = {"block": [0.6, 0.4], "thickness": 0.4, "courses": d.randint(2, 3), "walls": walls}
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
    table: Tables = {"size": [0.7, d.size(0.6, 1.2)], "course": [0.25, 0.03], "face": [0.2, 0.03]}
    return table | {"cell": 0.2, "through": d.choice([0, 2])}


STRUCTURES: dict[str, Callable[[Draw], Tables]] = {
    "wall": wall,
    "column": column,
    "arch": arch,
    "bridge": bridge,
    "voronoi-wall": lambda d: stones(d, cells=d.randint(4, 12), relax=d.choice([0, 3, 10])),
    "coursed-wall": coursed,
    "herringbone-wall": lambda d: stones(d, block=[d.choice([0.4, 0.6]), 0.2]) | d.some(0.3, bond="rows"),
    "wall-section": section,
    "drums": drums,
    "temple-front": temple,
    "vault": vault,
    "building": building,
}  # fmt: skip
IN_SPACE = ("drums", "temple-front", "vault", "building")
