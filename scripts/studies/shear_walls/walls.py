"""A wall of the study under displacement control: its curve, its peak and the tests that its case compares it with."""

from __future__ import annotations

import time
from collections.abc import Mapping
from typing import TYPE_CHECKING, Any

import numpy as np

from dem_cli.analyses.solve import solve
from dem_cli.app import api
from dem_cli.results.output.reference import verdicts
from dem_cli.results.post import style
from studies.observer import RunKeeper
from studies.places import CASES

if TYPE_CHECKING:
    from matplotlib.axes import Axes
    from matplotlib.figure import Figure

FORCES = (30, 100, 200, 250)  # vertical loads [kN]
KN, MM = 1e-3, 1e3


def wall(force: int, *overrides: str) -> dict[str, Any]:
    """One wall, with other values of its case: `KEY=VALUE` as for --set."""
    name = f"shear_wall_sw{force}.toml"
    begun = time.process_time()
    loaded, seen = api.load_case(CASES / "validation" / name, overrides), RunKeeper()
    model = api.build_model(loaded)
    summary = solve(loaded.case, model, seen).summary
    seconds = round(time.process_time() - begun, 1)
    curve, answers = summary["capacity_curve"], verdicts(summary, loaded.case.reference)
    tests = [answer for answer in answers if "displacements" in answer]
    command = " ".join([f"dem run cases/validation/{name}", *(f"--set '{text}'" for text in overrides)])
    return {
        "command": command, "force": force, "status": summary["status"],
        "bracket": summary["failure_load_bracket"], "closure": float(f"{summary['energy_closure']:.2g}"),
        "bilinear": {name: rounded(value) for name, value in curve["bilinear"].items()},
        "displacements": [rounded(value) for value in curve["displacements"]],
        "loads": [rounded(value) for value in curve["loads"]],
        "loads_at": [[one["displacement"], rounded(one["load"])] for one in curve["loads_at"]],
        "tests": [
            {"displacements": test["displacements"], "loads": test["value"], "mean": rounded(test.get("mean_error")),
             "largest": rounded(test.get("largest_error")), "found": [rounded(value) for value in test["found"] or ()]}
            for test in tests
        ],
        "moments": summary.get("joint_state", {}).get("restraints", {}), "seconds": seconds,
    }  # fmt: skip


def peak(one: Mapping[str, Any]) -> tuple[float, float]:
    """Highest load of a curve [N], and its displacement [m]."""
    highest = int(np.argmax(one["loads"]))
    return one["loads"][highest], one["displacements"][highest]


def load_at(one: Mapping[str, Any], displacement: float) -> float | None:
    """Load of a curve at a displacement [m]; None: it ends before."""
    if displacement > one["displacements"][-1]:
        return None
    return float(np.interp(displacement, one["displacements"], one["loads"]))


def draw_tests(axis: Axes, one: Mapping[str, Any]) -> None:
    """Points of the tests of a wall, and the axes for curves beside them [mm, kN]."""
    for number, test in enumerate(one["tests"], 1):
        x, y = MM * np.array(test["displacements"]), KN * np.array(test["loads"])
        axis.plot(x, y, color=style.REFERENCE, lw=0.9, marker="os"[number - 1], ms=3, label=f"test {number}")
    axis.set_title(f"SW{one['force']}")
    axis.set(xlabel="displacement of the push [mm]", ylabel="horizontal load [kN]")


def draw_curve(axis: Axes, one: Mapping[str, Any], label: str, **line: Any) -> None:
    """A curve [mm, kN]."""
    axis.plot(MM * np.array(one["displacements"]), KN * np.array(one["loads"]), label=label, **line)


def legend_below(figure: Figure) -> None:
    """One legend for all panels, whose axes begin at nothing."""
    found = dict[str, Any]()
    for axis in figure.axes:
        axis.set_ylim(bottom=0.0)
        axis.set_xlim(left=0.0)
        found |= {label: handle for handle, label in zip(*axis.get_legend_handles_labels(), strict=True)}
    figure.legend(found.values(), found.keys(), loc="outside lower center", ncols=min(len(found), 4))


def rounded(value: Any) -> Any:
    """A number with five digits."""
    return float(f"{value:.5g}") if isinstance(value, float) else value
