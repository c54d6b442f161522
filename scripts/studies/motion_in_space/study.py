"""Study of blocks that move in space: one block beside exact motions, planar twins, structures and their books."""

from __future__ import annotations

import argparse
import math
import tempfile
from pathlib import Path
from typing import Any

import tomli
import tomli_w

from studies.motion_in_space import laws, single, structures, tables, twins
from studies.places import CASES
from studies.study import StudyRunner

MOVING = ("time-history", "settlement", "cycle")


class SpatialMotionStudy(StudyRunner):
    """Sections are measured one after the other, each row by itself."""

    def said(self, section: str, found: Any) -> str:
        return f"{section}: {len(found)} rows"

    def problems(self, section: str, found: Any) -> list[str]:
        return [
            f"{section}, {row['name']}: {row['status']}" for row in found if row.get("status", "ok") not in ("ok", "–")
        ]

    def measure(self, section: str, options: argparse.Namespace) -> Any:
        return list(self.sections[section]())


def rocking() -> list[dict[str, Any]]:
    """Prisms about straight and oblique edges, a box on its corner."""
    rows = [single.rocking("box", stiffness) for stiffness in (1e4, 1e5, 1e6)]
    rows += [single.rocking(name) for name in ("triangular prism", "trapezoid", "hexagon")]
    rows += [single.rocking("box", damping={"contact_fraction": 0.35}), single.box_on_corner()]
    return rows


def sliding() -> list[dict[str, Any]]:
    """Pads that slide and spin."""
    rows = [row for azimuth in (0.0, 30.0, 77.0) for row in single.sliding(azimuth)]
    return [*rows, single.spinning(), *single.sliding_and_spinning()]


def flight() -> list[dict[str, Any]]:
    """Free flight, bounces, drops, a beam on a ridge."""
    rows = [single.flying(), *single.bouncing(0.0), *single.bouncing(0.1)]
    rows += [single.cube_on_corner(), single.cube_on_corner({"contact_fraction": 0.35})]
    return [*rows, *(single.beam_on_ridge(margin) for margin in (0.1, 0.05, 0.025))]


def built() -> list[dict[str, Any]]:
    """Structures."""
    return [
        structures.wall_collapses({"contact_fraction": 0.35}),
        structures.wall_collapses(None),
        structures.rocks_two_ways(),
        structures.column_of_drums(),
        structures.corner_opens(),
        structures.arch_spreads(),
    ]


def moving_twins() -> list[dict[str, Any]]:
    """Every case of the plane under cases/verification that moves."""
    files = sorted((CASES / "verification").glob("*.toml"))
    kinds = {file: tomli.loads(file.read_text(encoding="utf-8")).get("analysis", {}).get("kind") for file in files}
    return [twins.compared(file) for file in files if kinds[file] in MOVING]


def shaken_laws() -> list[dict[str, Any]]:
    """A column that slides and rocks on joints of every law, in the plane and as prisms."""
    rows = []
    with tempfile.TemporaryDirectory() as folder:
        for name, joint in laws.JOINTS.items():
            file = Path(folder) / f"{name}.toml"
            file.write_text(tomli_w.dumps(laws.shaken_column(joint)), encoding="utf-8")
            other = twins.of_plane(file, f"analysis.margin={laws.OTHER_MARGIN}")
            rows.append(twins.compared(file) | {"other": other})
    return rows


def error(row: dict[str, Any]) -> float | None:
    """Of what was found, relative; None: nothing to compare it with."""
    if row["exact"] is None or row["found"] is None or math.isnan(row["found"]):
        return None
    return row["found"] / row["exact"] - 1.0 if row["exact"] else row["found"]


STUDY = SpatialMotionStudy(
    "motion_in_space",
    "Blocks that move in space",
    {
        "rocking": rocking,
        "sliding": sliding,
        "flight": flight,
        "twins": moving_twins,
        "laws": shaken_laws,
        "structures": built,
    },
    tables.values,
    machine=True,
)
