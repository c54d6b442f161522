"""The case files under cases/, and what the oracle needs of them: polygons, weights, loads."""

from __future__ import annotations

import tomllib
from dataclasses import dataclass
from functools import cache
from pathlib import Path

import numpy as np
from oracle.limit_lp import LimitLoad, bodies_area_and_centroid, frictionless_heads, limit_load
from oracle.surface_loads import falling, surface_load

from dem_cli.case.reference import Reference
from dem_cli.case.tables.analysis import PushoverAnalysis
from dem_cli.case.tables.safety import SafetyAnalysis
from dem_cli.masonry.structures.placement import place
from dem_cli.masonry.structures.registry import GENERATORS

CASES = Path(__file__).resolve().parents[2] / "cases"
FILES = sorted(CASES.rglob("*.toml"))


def read(path: Path) -> dict:
    """The tables of a case file, as they stand there."""
    return tomllib.loads(path.read_text(encoding="utf-8"))


PLANAR = [path for path in FILES if read(path).get("dimension", 2) == 2]


def known_to_the_oracle(path: Path) -> bool:
    """Blocks in the plane, one kind of plane joint whose friction stays, no bars, nothing held."""
    case = read(path)
    (joint, *others) = case["joints"].values()
    return (
        path in PLANAR
        and not others
        and not {"reinforcement", "restraint"} & set(case)
        and joint.get("law", "coulomb") == "coulomb"
        and not {"profile", "softening"} & set(joint)
    )


def references(path: Path) -> list[dict]:
    """Its [reference] tables."""
    found = read(path).get("reference", [])
    return found if isinstance(found, list) else [found]


def failure_load(path: Path, kind: str = "exact") -> dict | None:
    """The first of its references that is a failure load of this kind, as a table with its tolerance; None: none is."""
    found = next((one for one in references(path) if "failure_load" in one and one.get("kind", "exact") == kind), None)
    return found and {**found, "tolerance": allowance(path, found)}


def allowance(path: Path, table: dict) -> float | None:
    """What a reference of a pushover or safety analysis allows, by its own tolerance or the rule of its kind."""
    reference, analysis = Reference.model_validate(table), read(path)["analysis"]
    usual = {one().kind: one().resolution for one in (PushoverAnalysis, SafetyAnalysis)}
    reference.resolved_to(analysis.get("resolution", usual[analysis.get("kind", "pushover")]))
    return reference.allowance


def case_id(path: Path) -> str:
    return str(path.relative_to(CASES).with_suffix(""))


@dataclass(frozen=True, eq=False)
class Scene:
    """Convex polygons and the bodies that they are parts of; everything else by body."""

    ids: list[str]
    polygons: list[np.ndarray]
    bodies: np.ndarray
    fixed: np.ndarray
    weights: np.ndarray  # [N]
    live: np.ndarray  # fx, fy, moment, (n, 3)
    dead: np.ndarray
    friction: float

    def limit(self, heads: bool = True) -> LimitLoad:
        """The associated failure load, with or without friction in joints steeper than 45°."""
        return _limit(self, heads)


@cache
def _limit(scene: Scene, heads: bool) -> LimitLoad:
    """Several tests ask for the same one."""
    return limit_load(
        scene.polygons,
        scene.fixed,
        scene.friction if heads else frictionless_heads(scene.friction),
        weights=scene.weights,
        live=scene.live,
        dead=scene.dead,
        bodies=scene.bodies,
    )


def blocks_of(tables: dict) -> list[tuple[str, tuple[np.ndarray, ...], str, float, bool]]:
    """(id, parts, material, thickness, fixed) of every block of a case."""
    only_material = next(iter(tables["materials"]))
    blocks = []
    for i, table in enumerate(tables.get("structure", [])):
        generator = GENERATORS[table["kind"]]
        named = {"id": table["kind"], "material": only_material, **table}
        parameters = generator.parameters.model_validate(named)
        for block in place(generator.build(parameters), parameters, ("structure", i)):
            blocks.append((block.id, block.parts, block.material, block.thickness, block.fixed))
    for table in tables.get("imperfection", []):
        blocks = [lower(block, -table["height"]) if block[0] == table["block"] else block for block in blocks]
    for table in tables.get("block", []):
        parts = table.get("parts") or [table["vertices"]]
        parts = tuple(np.array(part, dtype=float) for part in parts)
        material = table.get("material", only_material)
        blocks.append((table["id"], parts, material, table.get("thickness", 1.0), table.get("fixed", False)))
    return blocks


def lower(block: tuple, by: float) -> tuple:
    """A rectangular block with its top lower [m]; what lies above must rest on others as well and stay."""
    corners = block[1][0].copy()
    corners[corners[:, 1] > corners[:, 1].mean(), 1] -= by
    return (block[0], (corners,), *block[2:])


def _selected(table: dict, name: str, block: tuple) -> bool:
    """Whether a pressure or a fill acts on a block: it is named, or can move and is part of the structure that is."""
    return name == table.get("block") or (not block[4] and name.startswith(table.get("structure", " ") + "-"))


@cache
def scene(path: Path) -> Scene:
    """The structure of a case file with its loads; its limit load needs one joint law for all (Coulomb)."""
    tables = read(path)
    joint = next(iter(tables["joints"].values()))
    blocks = blocks_of(tables)
    polygons = [part for block in blocks for part in block[1]]
    bodies = np.repeat(np.arange(len(blocks)), [len(block[1]) for block in blocks])
    areas, centroids = bodies_area_and_centroid(polygons, bodies)
    densities = [tables["materials"][block[2]]["density"] for block in blocks]
    weights = areas * densities * [block[3] for block in blocks] * tables.get("gravity", 9.81)
    ids = [block[0] for block in blocks]
    loads = {"live": np.zeros((len(blocks), 3)), "dead": np.zeros((len(blocks), 3))}
    for load in tables.get("load", []):
        if "block" in load:
            i_block = ids.index(load["block"])
            hits = [(i_block, np.array(load.get("at", centroids[i_block])), 1.0)]
        else:
            hits = falling(polygons, np.array(load["at"]), load.get("spread", 0.0))
        for part, at, share in hits:
            i_block = part if "block" in load else bodies[part]
            force, arm = share * np.array(load["force"]), at - centroids[i_block]
            loads[load.get("kind", "dead")][i_block] += [*force, arm[0] * force[1] - arm[1] * force[0]]
    for table in [*tables.get("pressure", []), *tables.get("fill", [])]:
        for part, i_block in enumerate(bodies):
            if _selected(table, ids[i_block], blocks[i_block]):
                found = surface_load(polygons, part, centroids[i_block], table, tables.get("gravity", 9.81))
                loads[table.get("kind", "dead")][i_block] += found * blocks[i_block][3]
    analysis = tables.get("analysis", {})
    if analysis.get("pattern", "mass") != "live":
        direction = np.array(analysis.get("direction", [1.0, 0.0]))
        direction = direction / np.hypot(*direction)
        loads["live"] = np.column_stack([weights[:, None] * direction, np.zeros(len(blocks))])
    friction = joint.get("friction", np.tan(np.radians(joint.get("friction_angle_deg", 0.0))))
    fixed = np.array([block[4] for block in blocks])
    return Scene(ids, polygons, bodies, fixed, weights, loads["live"], loads["dead"], friction)
