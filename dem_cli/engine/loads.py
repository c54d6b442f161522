"""Loads of a simulation: dead and live loads of the free blocks, and the scales of their unbalanced forces."""

from __future__ import annotations

import numpy as np

from dem_cli.kernels.records import Loads
from dem_cli.model.model import Model
from dem_cli.model.scales import own_weights


def loads_of(model: Model, live_scale: float, radii: np.ndarray, narrowest_arm: float) -> Loads:
    """Loads of the blocks that can move, without masses and limits of speed yet.

    live_scale: factor on the live loads; radii: of the blocks [m], (n_blocks,); narrowest_arm: of its radius, the
    least width that a block's moments are compared with.
    """
    d = model.dimension
    dead = _with_modes(model.dead_loads, model.dead_mode_loads)
    live = _with_modes(model.live_loads, model.live_mode_loads) * live_scale
    dead[model.fixed] = 0.0
    live[model.fixed] = 0.0
    force_scales = np.empty_like(dead)
    force_scales[:] = 1.0 / own_weights(dead, live, d)[:, None]
    arms = np.clip(model.shapes.widths, narrowest_arm * radii, radii)  # small moments turn a needle over
    force_scales[:, model.rotations] /= arms[:, None]
    for loads in (dead, live):  # what restraints take does no work
        loads[:, : model.rotations.stop][model.held] = 0.0
    return Loads(
        dead=np.ascontiguousarray(dead),
        live=np.ascontiguousarray(live),
        inverse_masses=np.zeros_like(dead),
        force_scales=force_scales,
        speed_limits=np.full_like(dead, np.inf),
    )


def _with_modes(loads: np.ndarray, on_modes: np.ndarray) -> np.ndarray:
    """Loads of blocks, behind them those of their modes; a copy."""
    return np.column_stack([loads, on_modes]) if on_modes.shape[1] else loads.copy()
