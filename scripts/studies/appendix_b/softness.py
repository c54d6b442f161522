"""Joints of Appendix B: how far the top moves on them at failure, and what softer, stiffer and rigid ones carry."""

from __future__ import annotations

from typing import Any

import numpy as np
from bench.table import percent
from reference import results

from studies.appendix_b.sweep import RIGID, changed, kn_of, planned
from studies.template import table

COMPUTED = ("test 1", "test 2", "test 4", "test 5", "test 8")  # walls of the thesis's DEM whose tops move
TRIED = {"test 1": (0.5, 2.0, 10.0), "test 2": (2.0,), "test 4": (0.5, 2.0, 10.0)}  # of the stiffness as stated
STATED = 0.005 * 595.0  # largest displacement of the top at failure [mm]


def measure() -> dict[str, Any]:
    """Rigid joints for all walls; the stated ones, and others, where the way of the top is wanted."""
    loaded = [name for name in COMPUTED if planned()[name].values["kg"] != "0"]
    ways = [(name, share) for name in COMPUTED for share in (1.0, *TRIED.get(name, ()))]
    return {
        "rigid": {name: changed(name, RIGID) for name in planned() if name != "test 13"},
        "others": [{"name": name, "share": share} | changed(name, joints(share * kn_of(name))) for name, share in ways],
        "one": {name: changed(name, joints(kn_of("test 4"))) for name in loaded},
    }


def joints(kn: float) -> dict[str, float]:
    """All joints of this stiffness [Pa/m]."""
    return {"joints.dry.kn": kn, "joints.mortar.kn": kn}


def values(found: dict[str, Any]) -> dict[str, Any]:
    """What softness.md.j2 shows."""
    head = ("test", "kn [Pa/m]", "of the stated", "dem", "rigid joints", "change", "top at failure [mm]",
            "of the height")  # fmt: skip
    stated = [top_at_failure(one["name"], one) for one in found["others"] if one["share"] == 1.0]
    far = [top_at_failure(name, one) for name, one in found["one"].items()]
    loads = [f"{middle(one):.3f} for {name}" for name, one in found["one"].items()]
    return {
        "others": table(head, (cells(one, found["rigid"]) for one in found["others"])), "least": min(stated),
        "most": max(stated), "limit": STATED, "near": min(far), "far": max(far), "loads": ", ".join(loads),
        "twice": [change(found, name, 2.0) for name in ("test 1", "test 2", "test 4")],
        "ten": change(found, "test 4", 10.0),
    }  # fmt: skip


def change(found: dict[str, Any], name: str, share: float) -> float:
    """Of a load, on joints of `share` times the stiffness as stated [%]."""
    loads = {one["share"]: middle(one) for one in found["others"] if one["name"] == name}
    return 100.0 * (loads[share] / loads[1.0] - 1.0)


def cells(one: dict[str, Any], rigid: dict[str, Any]) -> tuple[str, ...]:
    """One line of the table."""
    name, share, load = one["name"], one["share"], middle(one)
    stiff, top = middle(rigid[name]), top_at_failure(name, one)
    return (name.removeprefix("test "), power(share * kn_of(name)), f"{share:g}", f"{load:.4f}", f"{stiff:.4f}",
            percent(load / stiff - 1.0), f"{top:.1f}", f"{top / 5.95:.2f} %")  # fmt: skip


def power(kn: float) -> str:
    """A stiffness with two digits: 3.1e9."""
    return f"{kn:.1e}".replace("e+0", "e").replace("e+", "e")


def middle(one: dict[str, Any]) -> float:
    """Middle of the bracket of a run."""
    return 0.5 * sum(one["bracket"])


def top_at_failure(name: str, one: dict[str, Any]) -> float:
    """How far the top has moved where the thesis's steps of the load, on average, hold for the last time [mm].

    That is half a step below failure; how wide its steps are its brackets tell.
    """
    low, high = results("thesis_appendix_b")[f"B{name.split()[-1]}_num"]["value"]
    loads, tops = np.array(one["held"]).T
    return float(np.interp(middle(one) * (1.0 - (high - low) / (high + low)), loads, tops))


PICTURES: dict[str, Any] = {}
