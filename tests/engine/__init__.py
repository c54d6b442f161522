"""What tests of the engine need: cases from a table, simulations, runs without files."""

from __future__ import annotations

import tempfile
from dataclasses import dataclass, field
from pathlib import Path
from typing import Any, NamedTuple

import numpy as np
import tomli_w

from dem_cli.analyses import solve as solver
from dem_cli.app.api import load_case
from dem_cli.case.schema import Case
from dem_cli.core.engine.kinematics import live_scale
from dem_cli.core.engine.loops import compiled_advance
from dem_cli.core.engine.properties import joint_properties, law_of
from dem_cli.core.engine.settings import DEFAULT, Settings
from dem_cli.core.engine.simulation import Simulation
from dem_cli.core.kernels import records as slot
from dem_cli.core.model.model import Model
from dem_cli.core.records.frames import Frame
from dem_cli.core.records.history_rows import HistoryRow, Samples
from dem_cli.core.records.ports import Observer
from dem_cli.core.records.requests import SolverRequest
from dem_cli.masonry.assembly.assemble import assembly
from dem_cli.masonry.assembly.solver_request import solver_request

MU, DENSITY = 0.6, 2000.0


class Scene(NamedTuple):
    """A case and its model."""

    case: Case
    model: Model

    @property
    def request(self) -> SolverRequest:
        return solver_request(self.case)

    def number(self, name: str) -> int:
        return self.model.block_ids.index(name)


@dataclass
class Records(Observer):
    """An observer that only remembers."""

    rows: list[HistoryRow] = field(default_factory=list)
    frames: list[Frame] = field(default_factory=list)
    stretches: list[Samples] = field(default_factory=list)
    models: list[Model] = field(default_factory=list)

    def frame(self, frame: Frame) -> None:
        self.frames.append(frame)

    def row(self, row: HistoryRow) -> None:
        self.rows.append(row)

    def samples(self, samples: Samples) -> None:
        self.stretches.append(samples)

    def structure(self, model: Model) -> None:
        self.models.append(model)

    @property
    def history(self) -> Samples:
        """The whole time history, without the coda."""
        motion = [samples for samples in self.stretches if not samples.coda]
        return Samples(*(np.concatenate(parts) for parts in zip(*(samples[:3] for samples in motion), strict=True)))


def rectangle(left: float, bottom: float, right: float, top: float) -> list[list[float]]:
    return [[left, bottom], [right, bottom], [right, top], [left, top]]


def turned(vertices, angle: float, about=(0.0, 0.0)) -> list[list[float]]:
    """The same polygon turned counter-clockwise [rad]."""
    c, s = np.cos(angle), np.sin(angle)
    arms = np.asarray(vertices) - about
    return (arms @ np.array([[c, s], [-s, c]]) + about).tolist()


def block(name: str, vertices, **more) -> dict:
    return {"id": name, "vertices": [list(map(float, v)) for v in vertices], **more}


def tables(*blocks: dict, friction: float = MU, density: float = DENSITY, **more) -> dict:
    """A case of explicit blocks; `more` adds tables or replaces them."""
    return {
        "materials": {"stone": {"density": density}},
        "joints": {"dry": {"friction": friction}},
        "block": list(blocks),
        "output": {"frames": 0},
        **more,
    }


def scene(case: dict | Path, *overrides: str) -> Scene:
    """The case of a table or of a file, not validated for geometry."""
    if isinstance(case, Path):
        loaded = load_case(case, overrides)
    else:
        with tempfile.TemporaryDirectory() as folder:
            path = Path(folder) / "case.toml"
            path.write_text(tomli_w.dumps(case), encoding="utf-8")
            loaded = load_case(path, overrides)
    return Scene(loaded.case, assembly(loaded.case).model)


def solve(case: dict | Path, *overrides: str, settings: Settings = DEFAULT) -> tuple[dict[str, Any], Records]:
    """Summary of a run and what its observer saw."""
    made, records = scene(case, *overrides), Records()
    return solver.solve(made.case, made.model, records, settings=settings).summary, records


def simulation(case: dict | Path, kinematics: str = "fixed", ratio: float = 1e6) -> Simulation:
    """As the analyses make it, with their scale of the live loads."""
    made = scene(case)
    tilting = made.case.analysis.kind == "pushover" and made.case.analysis.pattern == "tilt"
    return Simulation(
        made.model,
        law_of(made.request),
        joint_properties(made.request, made.model, ratio),
        kinematics,
        live_scale=1.0 if tilting else live_scale(made.model),
        tilting=tilting,
    )


def steps(sim: Simulation, n: int, mode: int = slot.HOLD_LOAD, dt: float = 1.0) -> int:
    """Straight to the compiled loop, with a time step and without detection."""
    kinds, profiled = sim.kinds_of_links, sim.properties.profiled
    loop = compiled_advance(sim.kinematics, sim.law, profiled, sim.model.dimension, kinds, elastic=sim.integrates)
    return loop(
        n, mode, dt, sim.bodies, sim.shape, sim.joints, sim.geometry, sim.contacts, sim.links, sim.loads,
        sim.control, sim.ledger, sim.like, sim.like_rotation,
    )  # fmt: skip


def real_masses(sim: Simulation) -> None:
    """Dynamics: real masses, no damping."""
    model = sim.model
    masses = np.column_stack([np.repeat(model.masses[:, None], model.dimension, axis=1), model.inertias])
    sim.loads.inverse_masses[:] = np.where(model.fixed[:, None], 0.0, 1.0 / masses)
    sim.control[slot.DAMP] = sim.control[slot.DAMP_CHANGE] = 0.0


def highest_frequency(sim: Simulation) -> float:
    """Of the present contacts, sticking [rad/s]; Gershgorin's bound."""
    from dem_cli.core.engine.fictitious_masses import fictitious_masses

    needed = np.zeros_like(sim.loads.inverse_masses)
    fictitious_masses(sim.model, sim.joints, sim.bodies, sim.shape, 1.0, needed)
    free = ~sim.model.fixed
    return float(2.0 * np.sqrt((sim.loads.inverse_masses[free] / needed[free]).max()))


def mirrored(case: dict) -> dict:
    """The mirror image of a case of explicit blocks, pushed the other way."""
    blocks = [{**b, "vertices": [[-x, y] for x, y in b["vertices"]]} for b in case["block"]]
    analysis = dict(case.get("analysis", {}))
    dx, dy = analysis.get("direction", [1.0, 0.0])
    return {**case, "block": blocks, "analysis": {**analysis, "direction": [-dx, dy]}}


def moved(case: dict, factor: float = 1.0, shift=(0.0, 0.0)) -> dict:
    """The same blocks, scaled and shifted."""
    blocks = [
        {**b, "vertices": [[factor * x + shift[0], factor * y + shift[1]] for x, y in b["vertices"]]}
        for b in case["block"]
    ]
    return {**case, "block": blocks}


def running_wall(courses: int, n_blocks: int, length: float = 0.04, height: float = 0.0175) -> list[dict]:
    """Explicit blocks of a wall in running bond on a base; half blocks end every second course."""
    blocks = [block("base", rectangle(-length, -height, (n_blocks + 1) * length, 0.0), fixed=True)]
    for course in range(courses):
        cuts = np.arange(n_blocks + 1) * length
        if course % 2:
            cuts = np.concatenate([[0.0], cuts[:-1] + 0.5 * length, [n_blocks * length]])
        for i, (left, right) in enumerate(zip(cuts[:-1], cuts[1:])):
            corners = rectangle(left, course * height, right, (course + 1) * height)
            blocks.append(block(f"b{course}-{i}", corners))
    return blocks
