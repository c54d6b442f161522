"""The arch of 17 voussoirs of Lemos and Sarhosis under a half sine, and what its answer depends on."""

from __future__ import annotations

from collections.abc import Callable, Mapping
from typing import Any

import numpy as np
from oracle import maxwell

from studies.polygons import rectangle
from studies.pulses import column
from studies.pulses.domain import changed, table_of
from studies.rocking.single_block import Response, solve

CASE, ELASTIC = "lemos_arch_pulse", "lemos_arch_elastic"
INNER, RING, VOUSSOIRS = 3.75, 0.5, 17  # m, m, -
MAXWELL = {"maxwell": [{"ratio": ratio, "frequency": f} for ratio, f in maxwell.PUBLISHED]}
RUNS = {  # law, damping; None: that of the case, stiffness-proportional
    "elastic_s5": (ELASTIC, None),
    "elastic_mx5": (ELASTIC, MAXWELL),
    "s5": (CASE, None),
    "mx5": (CASE, MAXWELL),
}
FREQUENCY, KN = 11.0, 1e10  # where 5 % hold [Hz]; [Pa/m]
STATIC_SHARE = 1.0 / (1.0 + sum(4.0 * ratio for ratio, _ in maxwell.PUBLISHED))


def voussoirs(parts: int) -> list[dict[str, Any]]:
    """[[block]] tables of the ring, each voussoir cut into so many parts across it."""
    angles = np.pi * (1.0 - np.arange(VOUSSOIRS + 1) / VOUSSOIRS)
    radii = INNER + RING * np.arange(parts + 1) / parts
    x, y = np.outer(np.cos(angles), radii), np.outer(np.sin(angles), radii)
    corners = np.stack([x, np.where(np.abs(y) < 1e-12, 0.0, y)], axis=2)
    blocks = []
    for k in range(VOUSSOIRS):
        cut = [[corners[at].tolist() for at in ((k, j), (k + 1, j), (k + 1, j + 1), (k, j + 1))] for j in range(parts)]
        shape = {"vertices": cut[0]} if parts == 1 else {"parts": cut}
        blocks.append({"id": f"voussoir-{k + 1}", **shape})
    return blocks


def with_parts(case: Mapping[str, Any], parts: int) -> dict[str, Any]:
    """The case with voussoirs of another number of parts."""
    return changed(case, block=[*voussoirs(parts), *(block for block in case["block"] if block.get("fixed"))])


def narrow(case: Mapping[str, Any]) -> dict[str, Any]:
    """The case on bases as wide as the ring."""
    blocks = [block for block in case["block"] if not block.get("fixed")]
    for name, left in (("left", -INNER - RING), ("right", INNER)):
        blocks.append({"id": f"base-{name}", "vertices": rectangle(left, -0.5, left + RING, 0.0), "fixed": True})
    return changed(case, block=blocks)


def joints(case: Mapping[str, Any], **keys: Any) -> dict[str, Any]:
    return changed(case, joints={"dry": {**case["joints"]["dry"], **keys}})


def _friction(case: Mapping[str, Any], coefficient: float) -> dict[str, Any]:
    dry = {key: value for key, value in case["joints"]["dry"].items() if key != "friction_angle_deg"}
    if dry["law"] == "coulomb":
        dry["friction"] = coefficient
    return changed(case, joints={"dry": dry})


def _at(case: Mapping[str, Any], frequency: float) -> dict[str, Any]:
    return changed(case, damping={"rayleigh": {"ratio": 0.05, "frequency": frequency, "mass": False}})


def _softer_for_maxwell(case: Mapping[str, Any]) -> dict[str, Any]:
    """kn and ks that hold with the elements at high frequencies; the springs alone have the rest."""
    return joints(case, kn=STATIC_SHARE * KN, ks=STATIC_SHARE * KN)


VARIANTS: dict[str, tuple[str, Callable[[Mapping[str, Any]], dict[str, Any]]]] = {  # group, change
    "as the case": ("", dict),
    "2 points (1/2, 1/2)": ("points across the ring", lambda case: with_parts(case, 1)),
    "3 points (1/6, 2/3, 1/6)": ("points across the ring", lambda case: joints(with_parts(case, 1), points=3)),
    "5 points (Gauss–Lobatto)": ("points across the ring", lambda case: joints(with_parts(case, 1), points=5)),
    "5 points (1/8, 1/4, 1/4, 1/4, 1/8)": ("points across the ring", lambda case: with_parts(case, 4)),
    "5 % at 5.5 Hz": ("reference frequency", lambda case: _at(case, 0.5 * FREQUENCY)),
    "5 % at 7.1 Hz": ("reference frequency", lambda case: _at(case, 7.1)),
    "5 % at 16.5 Hz": ("reference frequency", lambda case: _at(case, 1.5 * FREQUENCY)),
    "ks = 0.4 kn": ("stiffness", lambda case: joints(case, ks=0.4 * KN)),
    "ks = 2 kn": ("stiffness", lambda case: joints(case, ks=2.0 * KN)),
    "kn = ks = 2e10": ("stiffness", lambda case: joints(case, kn=2.0 * KN, ks=2.0 * KN)),
    "kn and ks with the elements": ("stiffness", _softer_for_maxwell),
    "bases as wide as the ring": ("support", narrow),
    "friction 1.5": ("friction", lambda case: _friction(case, 1.5)),
    "a third of the time step": ("time step", lambda case: changed(case, analysis={"margin": 0.05})),
}


def peaks(found: Response) -> dict[str, Any]:
    """Largest displacement and the largest to the other side [m] from rest, with their times [s]."""
    moved = found.values[:, 0] - found.values[0, 0]
    high, low = int(moved.argmax()), int(moved.argmin())
    return {
        "values": [float(moved[high]), float(moved[low])],
        "times": [float(found.times[high]), float(found.times[low])],
        "closure": float(found.summary["energy_closure"]),
        "shares": {name: float(share) for name, share in found.summary["energy_shares"].items()},
    }


def run(name: str, change: Callable[[Mapping[str, Any]], dict[str, Any]] = dict) -> Response:
    """One of RUNS, changed."""
    case, damping = RUNS[name]
    made = change(table_of(case))
    return solve(changed(made, damping=damping or made["damping"], output={"frames": 0}))


def frequencies(case: Mapping[str, Any]) -> list[float]:
    """First natural frequencies under gravity [Hz]."""
    made = changed(case, motion=None, damping=None, monitor=None) | {"analysis": {"kind": "modes", "count": 3}}
    return [float(f) for f in solve(made).summary["frequencies"]]


EDGES = ("2 points (1/2, 1/2)", "as the case", "3 points (1/6, 2/3, 1/6)", "5 points (Gauss–Lobatto)")
STIFFNESSES = (1e10, 1e11)  # Pa/m


def edges() -> list[dict[str, Any]]:
    """Largest displacement [m] of no-tension joints by places of contact points and stiffness."""
    rows = []
    for label in EDGES:
        for kn in STIFFNESSES:
            found = run("s5", lambda case, kn=kn, label=label: joints(VARIANTS[label][1](case), kn=kn, ks=kn))
            rows.append({"label": label, "kn": kn, "peak": peaks(found)["values"][0]})
            print(f"arch of 17: {rows[-1]}")
    return rows


MARGINS = (0.3, 0.2, 0.15, 0.1, 0.05)


def steps() -> list[dict[str, Any]]:
    """Both peaks of no-tension joints with Maxwell elements by the time step."""
    return [
        {"margin": margin} | peaks(run("mx5", lambda case, m=margin: changed(case, analysis={"margin": m})))
        for margin in MARGINS
    ]


def free_vibration(found: Response, after: float = 0.26) -> dict[str, float]:
    """Frequency [Hz] and damping ratio of an elastic arch after the pulse, by its first six extremes.

    Heights are from one extreme to the next: Maxwell elements leave an offset that decays slowly.
    """
    times, sizes = found._replace(values=found.values - found.values[0]).extremes()
    late = times > after
    times, sizes = times[late][:6], sizes[late][:6]
    drop = float(np.log((sizes[0] + sizes[1]) / (sizes[4] + sizes[5]))) / (4.0 * np.pi)
    return {"frequency": float(2.0 / (times[4] - times[0])), "ratio": float(drop / np.hypot(1.0, drop))}


def free() -> dict[str, Any]:
    """Free vibration of the elastic arch with both dampings."""
    found = {name: free_vibration(run(name)) for name in ("elastic_s5", "elastic_mx5")}
    print(f"arch of 17, free vibration: {found}")
    return found


def study() -> dict[str, Any]:
    """Peaks of all variants, histories of the case, frequencies, static load."""
    rows = []
    for label, (group, change) in VARIANTS.items():
        elastic = table_of(ELASTIC)
        row: dict[str, Any] = {"label": label, "group": group, "frequencies": frequencies(change(elastic))}
        row |= {name: peaks(run(name, change)) for name in RUNS}
        rows.append(row)
        said = ", ".join(f"{name} {1e3 * row[name]['values'][0]:.4f} mm" for name in RUNS)
        print(f"arch of 17, {label}: {row['frequencies'][0]:.2f} Hz, {said}")
    whole = {name: run(name) for name in RUNS}
    return {
        "variants": rows,
        "histories": {
            name: [np.round(1e3 * (h.values[::8, 0] - h.values[0, 0]), 4).tolist(), float(8e0 * h.times[1])]
            for name, h in whole.items()
        },
        "pressed": frequencies(table_of(CASE)),
        "elements": [[f, *maxwell.of_mode(f)] for f in (0.5, 1.0, 2.0, 5.0, 7.1, 11.0, 20.0, 50.0, 100.0)],
        "static": column.static(CASE),
    }
