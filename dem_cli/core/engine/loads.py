"""Loads of a simulation: dead and live loads of the free blocks, and the scales of their unbalanced forces."""

from __future__ import annotations

import numpy as np

from dem_cli.core.kernels.records import Bodies, Contacts, Joints, Loads
from dem_cli.core.model.model import Model
from dem_cli.core.model.scales import own_weights


def loads_of(model: Model, live_scale: float, radii: np.ndarray, narrowest_arm: float) -> Loads:
    """Collect the loads of the blocks that can move, without masses and limits of speed yet.

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
    """Append the loads of modes to those of blocks; a copy."""
    return np.column_stack([loads, on_modes]) if on_modes.shape[1] else loads.copy()


class ActingForces:
    """Reference force of each block's unbalanced force where other loads than weights act.

    That is the largest of its own weight, of a share of the live load on it, and of a smaller one of what its joints
    carry: a block of 0.6 N that is pulled with 40 kN is known to some digits of these, and not of its weight. Live
    loads of the order of the weights change nothing.

    loads: as `loads_of` makes them; masses: of the blocks [kg], (n_blocks,); free: numbers of those that can move;
    live, carried: these shares [-].
    """

    def __init__(
        self, loads: Loads, masses: np.ndarray, free: np.ndarray, dimension: int, live: float, carried: float
    ) -> None:
        self.scales, self.carried = loads.force_scales, carried
        dead, lively = (np.sqrt((part[:, :dimension] ** 2).sum(axis=1)) for part in (loads.dead, loads.live))
        self.own, self.live = 1.0 / loads.force_scales[:, 0], live * lively
        gravity = (dead[free] / masses[free]).min(initial=np.inf) if len(free) else 0.0
        applied = float((dead[free] - gravity * masses[free]).max(initial=0.0))
        self.loaded = carried * applied > float(self.own[free].min(initial=np.inf))
        self.most = float((self.live / self.own)[free].max(initial=0.0))  # of a live load, in weights of its block
        self.over_weights = float(self.live.sum() / dead.sum()) if dead.any() else 0.0

    def count(self, multiplier: float) -> bool:
        """Test whether loads other than weights matter at a multiplier of the live loads."""
        return self.loaded or abs(multiplier) * self.most > 1.0

    def growth(self, multiplier: float) -> float:
        """Return the ratio of all forces to those under the weights alone, as far as that counts; 1 at least [-]."""
        return max(abs(multiplier) * self.over_weights, 1.0)

    def largest_share(self, bodies: Bodies, joints: Joints, contacts: Contacts, multiplier: float) -> float:
        """Return the largest unbalanced force of a block in the last step, over its reference force [-]."""
        points = np.sqrt(contacts.normal**2 + (contacts.shear**2).sum(axis=1))
        carried = np.zeros(len(self.own))
        for side in joints.blocks.T:  # as much comes in as goes out
            carried += 0.5 * np.bincount(side[joints.owners], points, len(carried))
        measures = np.maximum(self.own, np.maximum(abs(multiplier) * self.live, self.carried * carried))
        shares = np.abs(bodies.unbalanced) * self.scales * (self.own / measures)[:, None]
        return float(shares.max(initial=0.0))
