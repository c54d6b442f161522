"""Structures whose failure loads are known, and what may be changed about them."""

from __future__ import annotations

import copy
import tomllib
from collections.abc import Callable, Sequence
from dataclasses import dataclass, replace
from typing import Any

import numpy as np

from dem_cli.app.api import build_model
from dem_cli.core.geometry import polygon
from dem_cli.masonry.assembly.assemble import case_blocks
from studies.places import CASES
from studies.polygons import rectangle
from studies.solution import from_tables

Tables = dict[str, Any]


@dataclass(frozen=True)
class StressScene:
    """A case as tables, the interval in which its failure load lies, and a change of its model."""

    name: str
    tables: Tables
    exact: tuple[float, float]
    change: Callable[[Any], Any] | None = None  # of the model, for what a case file cannot say

    def build(self) -> tuple[Any, Any, list[str]]:
        """Case, model and warnings. Raises CaseError as `dem run` does."""
        loaded = from_tables(self.tables)
        model = build_model(loaded)
        return loaded.case, model if self.change is None else self.change(model), loaded.warnings

    def having(self, keys: str, value: Any) -> StressScene:
        """The same scene with one value of its tables changed: "analysis.kinematics", "large"."""
        tables = copy.deepcopy(self.tables)
        *path, last = keys.split(".")
        table = tables
        for key in path:
            table = table.setdefault(key, {})
        table[last] = value
        return replace(self, tables=tables)

    def joint(self, **values: Any) -> StressScene:
        """With other parameters of its first joint."""
        scene, name = self, next(iter(self.tables["joints"]))
        for key, value in values.items():
            scene = scene.having(f"joints.{name}.{key}", value)
        return scene

    def material(self, **values: Any) -> StressScene:
        """With other parameters of all materials; numbers are factors."""
        tables = copy.deepcopy(self.tables)
        for material in tables["materials"].values():
            for key, factor in values.items():
                material[key] *= factor
        return replace(self, tables=tables)


def quiet(tables: Tables) -> Tables:
    """Without what costs time and says nothing about the failure load."""
    tables = {key: value for key, value in tables.items() if key not in ("monitor", "reference")}
    analysis = {**tables.get("analysis", {}), "follow": 0.0, "max_steps": 1_000_000}
    return {**tables, "analysis": analysis, "output": {"frames": 0}}


def from_file(name: str, stem: str, exact: float | tuple[float, float]) -> StressScene:
    """A case of cases/verification."""
    tables = tomllib.loads((CASES / "verification" / f"{stem}.toml").read_text(encoding="utf-8"))
    return StressScene(name, quiet(tables), exact if isinstance(exact, tuple) else (exact, exact))


def explicit(scene: StressScene) -> StressScene:
    """The same structure with every block drawn by hand, so that corners can be changed."""
    if "structure" not in scene.tables:
        return scene
    blocks, _ = case_blocks(from_tables(scene.tables).case)
    drawn = [
        {
            "id": b.id, "material": b.material, "thickness": float(b.thickness), "fixed": bool(b.fixed),
            "parts": [np.asarray(part).tolist() for part in b.parts],
        }
        for b in blocks
    ]  # fmt: skip
    tables = {key: value for key, value in scene.tables.items() if key != "structure"}
    return replace(scene, tables={**tables, "block": drawn})


# -- scenes drawn here -------------------------------------------------------------------------------


def block(name: str, corners: Sequence, **more: Any) -> Tables:
    return {"id": name, "vertices": [[float(x), float(y)] for x, y in corners], **more}


def drawn(
    name: str, blocks: Sequence[Tables], exact: float, friction: float, densities: Sequence[float] = (2400.0,)
) -> StressScene:
    """Explicit blocks; with several densities materials are called m0, m1, …"""
    tables = {
        "materials": {f"m{i}": {"density": density} for i, density in enumerate(densities)},
        "joints": {"dry": {"friction": friction}},
        "block": [{"material": "m0", **b} for b in blocks],
        "analysis": {"kind": "pushover"},
    }
    return StressScene(name, quiet(tables), (exact, exact))


def ground(width: float, height: float = 1.0) -> Tables:
    return block("ground", rectangle(-width, -height, 2.0 * width, 0.0), fixed=True)


def rocking_block(width: float, height: float = 1.0, friction: float = 1.0) -> StressScene:
    """Turns about its toe at b/h."""
    blocks = [ground(max(width, height)), block("b", rectangle(0, 0, width, height))]
    return drawn("rocking block", blocks, width / height, friction)


def stack(
    widths: Sequence[float], heights: Sequence[float], densities: Sequence[float], friction: float
) -> StressScene:
    """Blocks on top of each other, centred, each of its own density: slides at μ, or the part above a joint turns."""
    middle, level, blocks, rows = 0.5 * max(widths), 0.0, [ground(2.0 * max(widths))], []
    for i, (b, h, density) in enumerate(zip(widths, heights, densities, strict=True)):
        blocks.append(block(f"b{i}", rectangle(middle - b / 2, level, middle + b / 2, level + h), material=f"m{i}"))
        rows.append((b * h * density, level + h / 2, level, b if i == 0 else min(b, widths[i - 1])))
        level += h
    loads = [friction]
    for k, (_, _, foot, joint) in enumerate(rows):
        above = rows[k:]
        moment = sum(weight * (height - foot) for weight, height, _, _ in above)
        loads.append(0.5 * joint * sum(weight for weight, *_ in above) / moment)
    return drawn("stack", blocks, min(loads), friction, densities)


def trilith(foot: float = 0.4, height: float = 2.0, lintel: float = 1.0, column: float = 1.0) -> StressScene:
    """Two columns and a lintel, of two densities: b/H, whatever the weights (cases/verification/trilith.toml)."""
    blocks = [
        ground(4.0, 0.3),
        block("left", rectangle(0.0, 0.0, foot, height)),
        block("right", rectangle(3.0 - foot, 0.0, 3.0, height)),
        block("lintel", rectangle(-0.1, height, 3.1, height + 0.5), material="m1"),
    ]
    return drawn("trilith", blocks, foot / height, 0.7, (2600.0 * column, 2600.0 * lintel))


def named() -> dict[str, StressScene]:
    """The structures of the data book with exact loads, or the interval of those that are admissible."""
    return {
        "slide": from_file("sliding block", "sliding_block", 0.4),
        "rock": rocking_block(0.25),
        "column": from_file("column of 14", "column_14", 0.04 / 0.245),
        "trilith": from_file("trilith", "trilith", 0.2),
        "wall 0.5": from_file("wall, μ 0.5", "wall_21_mu050", 0.5),
        "wall 0.6": from_file("wall, μ 0.6", "wall_21", 0.6),
        # Limit analysis without and with friction in the head joints (tests/oracle): between them all are admissible.
        "wall 0.65": from_file("wall, μ 0.65", "wall_21_mu065", (0.639969, 0.642859)),
        "wall 0.7": from_file("wall, μ 0.7", "wall_21_mu070", (0.643226, 0.661654)),
        "wall 0.75": from_file("wall, μ 0.75", "wall_21_mu075", 0.645963),
        "wall 1.0": from_file("wall, μ 1.0", "wall_21_mu100", 0.645963),
        "arch": from_file("arch", "arch_21", 0.148315),
        "arch 0.4": from_file("arch, μ 0.4", "arch_21_mu040", 0.052164),
        "portal": from_file("portal", "portal", 0.324715),
        "groove": from_file("groove", "groove", 4.0),
    }


def stiffness_unit(scene: StressScene) -> float:
    """kn [Pa/m] at which a mean free block sinks by the shortest edge of any block: kn·h/W = 1."""
    case, model, _ = replace(scene, change=None).build()
    edges = model.vertices[polygon.following(model.part_starts)] - model.vertices
    free = ~model.fixed
    areas = np.bincount(model.part_blocks, polygon.properties_of_all(model.vertices, model.part_starts).area)
    joint = np.sqrt(areas[free]).mean() * model.thickness[free].mean()
    return float(case.gravity * model.masses[free].mean() / joint / np.hypot(*edges.T).min())
