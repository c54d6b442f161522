"""Hoop forces of a hemisphere under its own weight, course by course, against the membrane."""

from __future__ import annotations

from collections.abc import Sequence
from pathlib import Path
from typing import Any

import numpy as np

from dem_cli.results.post import style
from studies.template import table
from studies.vaults.runs import BONDED, DENSITY, GRAVITY, STIFF, courses_of, dome, last_contacts, solved

COURSES, STONES = 24, 24
CHANGE = 51.827  # cos φ = 1 / (1 + cos φ): where the hoops of a thin hemisphere change sign [deg]
KINDS = {  # thickness, joint, bond
    "joints that carry tension": (0.02, {"friction": 0.7} | BONDED | STIFF, "stack"),
    "dry, heads above heads": (0.1, {"friction": 0.7} | STIFF, "stack"),
    "dry, in bond": (0.1, {"friction": 0.7} | STIFF, "running"),
}


def membrane(angles: np.ndarray) -> np.ndarray:
    """Hoop force of a thin hemisphere over its weight per area times its radius, compression positive; angles [rad]."""
    return np.cos(angles) - 1.0 / (1.0 + np.cos(angles))


def hoop_forces(thickness: float, joint: dict[str, Any], bond: str) -> dict[str, Any]:
    """Angle from the crown of the middle of each course [deg], and its hoop force as `membrane` has it."""
    done = solved(dome(COURSES, STONES, thickness=thickness, bond=bond), joint, {"kind": "gravity"})
    contacts, course = last_contacts(done), courses_of(done.model)
    first, second = contacts.blocks.T
    heads = (course[first] == course[second]) & (course[first] > 0)
    sums = np.bincount(course[first[heads]], contacts.normal_force[heads], COURSES + 1)[1:]
    step = np.pi / (2 * COURSES + 1)
    angles = np.pi / 2.0 - step * (np.arange(COURSES) + 0.5)
    forces = sums / STONES / step / (DENSITY * GRAVITY * thickness)
    return {
        "status": done.summary["status"],
        "angles": np.round(np.degrees(angles), 3).tolist(),
        "forces": np.round(forces, 5).tolist(),
    }


def change_of_sign(angles: Sequence[float], forces: Sequence[float]) -> float:
    """Angle at which the hoop force goes from tension, or none, to compression [deg]; courses from the springing up."""
    first = next(k for k, force in enumerate(forces) if force > 1e-6)
    if forces[first - 1] > -1e-6:
        return angles[first - 1]
    share = forces[first] / (forces[first] - forces[first - 1])
    return angles[first] + share * (angles[first - 1] - angles[first])


def measure() -> dict[str, Any]:
    """All three domes."""
    return {name: hoop_forces(*keys) for name, keys in KINDS.items()}


def values(found: dict[str, Any]) -> dict[str, str]:
    """Table of the page."""
    rows = [[name, f"{change_of_sign(row['angles'], row['forces']):.1f}°"] for name, row in found.items()]
    return {"hoops": table(["dome", "hoops are without compression below"], rows), "change": f"{CHANGE:.1f}"}


def draw(found: dict[str, Any], path: Path) -> None:
    """Hoop force against the angle from the crown."""
    with style.figure(path, figsize=(6.4, 4.2)) as figure:
        axis = figure.subplots()
        angles = np.linspace(0.0, 90.0, 181)
        axis.plot(angles, membrane(np.radians(angles)), color=style.GREY, label="membrane")
        for (name, row), mark in zip(found.items(), "os^", strict=True):
            axis.plot(row["angles"], row["forces"], mark, ms=4, label=name)
        axis.axhline(0.0, color="black", lw=0.6)
        axis.axvline(CHANGE, color=style.GREY, lw=0.8, ls=":")
        axis.set(xlabel="angle from the crown [deg]", ylabel="hoop force / (ρ g t R)")
        axis.legend(loc="lower left")


PICTURES = {"hoops": draw}
