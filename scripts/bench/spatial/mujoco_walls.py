"""Structures of boxes in MuJoCo: free joints, geoms of equal friction, gravity that is tilted.

MuJoCo's contacts are springs of `solref` (time constant, damping ratio) whose friction creeps below the cone; the
shorter the time constant (two steps at least) and the larger `impratio`, the less a structure sinks and creeps.
"""

from __future__ import annotations

from typing import Any

import numpy as np

from bench.spatial.boxes import Boxes
from bench.tilting import EngineSettings

NAME, PACKAGE = "MuJoCo", "mujoco"
ITERATIONS = (100,)  # the library's own limit: Newton's method takes a few
ROUND = {"cone": "mjCONE_ELLIPTIC"}
FIRM = ROUND | {"solref": (0.004, 1.0), "impratio": 10.0}
FIRMER = ROUND | {"solref": (0.002, 1.0), "impratio": 30.0}
SETTINGS = (
    EngineSettings("defaults: 2 ms, pyramids; edge 0.1 m", 0.1, 9.81, 2e-3, ITERATIONS),
    EngineSettings("1 ms, elliptic cones; edge 0.1 m", 0.1, 9.81, 1e-3, ITERATIONS, options=ROUND),
    EngineSettings("… contacts of 4 ms, impratio 10; edge 0.1 m", 0.1, 9.81, 1e-3, ITERATIONS, options=FIRM),
    EngineSettings("… contacts of 2 ms, impratio 30; edge 0.3 m", 0.3, 9.81, 1e-3, ITERATIONS, True, FIRMER),
)


class MujocoWorld:
    """A structure of boxes, scaled so that its smallest edge is that of the setting."""

    def __init__(self, boxes: Boxes, friction: float, direction: tuple[float, float], setting: EngineSettings):
        import mujoco

        self.mujoco, self.setting = mujoco, setting
        self.direction = np.array(direction) / np.hypot(*direction)
        spec = mujoco.MjSpec()
        spec.option.timestep = setting.step
        spec.option.gravity = (0.0, 0.0, -setting.gravity)
        spec.option.solver = mujoco.mjtSolver.mjSOL_NEWTON
        spec.option.iterations = setting.iterations[0]
        if "cone" in setting.options:
            spec.option.cone = getattr(mujoco.mjtCone, setting.options["cone"])
        spec.option.impratio = setting.options.get("impratio", 1.0)
        scale = setting.edge / boxes.smallest_edge
        shape: dict[str, Any] = {"type": mujoco.mjtGeom.mjGEOM_BOX, "condim": 3, "friction": (friction, 0.0, 0.0)}
        if "solref" in setting.options:
            shape["solref"] = setting.options["solref"]
        for centre, size, fixed in zip(scale * boxes.centres, scale * boxes.sizes, boxes.fixed, strict=True):
            if fixed:
                spec.worldbody.add_geom(pos=centre, size=0.5 * size, **shape)
            else:
                body = spec.worldbody.add_body(pos=centre)
                body.add_freejoint()
                body.add_geom(size=0.5 * size, **shape)
        self.model = spec.compile()
        self.data = mujoco.MjData(self.model)
        mujoco.mj_forward(self.model, self.data)  # without a step: places are known

    def tilt(self, load: float) -> None:
        """Turn gravity so that its horizontal part is the load multiplier."""
        self.model.opt.gravity[:2] = load * self.setting.gravity * self.direction

    def step(self, steps: int) -> None:
        """Advance by so many steps."""
        self.mujoco.mj_step(self.model, self.data, steps)

    def places(self) -> np.ndarray:
        """Places of the free blocks, in units of the engine, (n, 3)."""
        return np.array(self.data.xipos[1:])
