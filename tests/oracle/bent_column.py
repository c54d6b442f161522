"""Column of rigid blocks on soft joints without tension, bent by a push: statics at prescribed displacements.

Finite rotations. The foot is on the ground, the right side of the top is held by a spring, the left side of one block
is pushed. Joints are elastic at given points, normal and shear, open, and carry shear up to their friction. Newton's
method on the forces of all blocks, from one displacement to the next.
"""

from __future__ import annotations

from dataclasses import dataclass

import numpy as np

LOBATTO = (-1.0, -np.sqrt(3 / 7), 0.0, np.sqrt(3 / 7), 1.0)  # places of five points, over half the width
SHARES = (0.05, 49 / 180, 64 / 180, 49 / 180, 0.05)  # of the joint
FRICTION = 0.7
SUPPORT = 5e6  # N/m per metre of depth: what holds the top moves by 0.04 mm


@dataclass(frozen=True)
class BentColumn:
    """Per metre of depth; the push is at the top left corner of block `pushed`, from 0."""

    blocks: int
    width: float  # [m]
    height: float  # of a block [m]
    density: float  # [kg/m3]
    kn: float  # [Pa/m]
    ks: float  # [Pa/m]
    pushed: int
    held: float  # below the top, where its right side is held [m]

    @property
    def weight(self) -> float:
        """Of a block [N/m]."""
        return self.density * 9.81 * self.width * self.height

    def loads(self, displacements: np.ndarray) -> np.ndarray:
        """Push over the weight of the column at each displacement of its point [m]; ArithmeticError: no equilibrium."""
        state = np.zeros(3 * self.blocks + 1)
        above = self.weight * np.arange(self.blocks, 0, -1)
        state[1:-1:3] = -1e3 * np.cumsum(above / (self.kn * self.width))
        at, found = 0.0, []
        for displacement in displacements:
            at, state = displacement, self._moved(state, at, displacement)
            found.append(state[-1])
        return np.array(found)

    def _moved(self, state: np.ndarray, at: float, to: float) -> np.ndarray:
        """The state at another displacement; where Newton's method fails, half way first."""
        found = self._newton(state, to)
        if found is None:
            middle = 0.5 * (at + to)
            if abs(to - at) < 1e-6:
                raise ArithmeticError(f"no equilibrium found at {to} m")
            found = self._moved(self._moved(state, at, middle), middle, to)
        return found

    def _newton(self, state: np.ndarray, displacement: float) -> np.ndarray | None:
        residual = self._residual(state, displacement)
        steps = 1e-7 * np.eye(len(state))
        for _ in range(50):
            if np.abs(residual).max() < 1e-7:
                return state
            columns = [self._residual(state + e, displacement) - self._residual(state - e, displacement) for e in steps]
            change = np.linalg.solve(np.array(columns).T / 2e-7, -residual)
            for share in 0.5 ** np.arange(12):
                new = self._residual(state + share * change, displacement)
                if np.linalg.norm(new) < np.linalg.norm(residual):
                    break
            else:
                return None
            state, residual = state + share * change, new
        return None

    def _residual(self, state: np.ndarray, displacement: float) -> np.ndarray:
        """Forces and moments on all blocks over a block's weight; what the pushed point lacks of its displacement.

        state: displacements [mm] and rotations [1/100] of the blocks from below, then the load.
        """
        n, half, tall = self.blocks, self.width / 2, self.height / 2
        moved = state[:-1].reshape(n, 3) * (1e-3, 1e-3, 1e-2)
        cos, sin = np.cos(moved[:, 2]), np.sin(moved[:, 2])
        centres = moved[:, :2] + np.stack([np.zeros(n), self.height * (np.arange(n) + 0.5)], 1)
        x = half * np.array(LOBATTO)

        def arms(x, y, block=slice(None)):
            c, s = cos[block, None], sin[block, None]
            return np.stack([c * x - s * y, s * x + c * y], -1)

        lower = arms(x, -tall)
        above = centres[:, None] + lower
        ground = np.stack([x, np.zeros_like(x)], -1)[None]
        below = np.concatenate([ground, (centres[:, None] + arms(x, tall))[:-1]])
        tilt = np.concatenate([[0.0], moved[:-1, 2]])
        normal = np.stack([-np.sin(tilt), np.cos(tilt)], 1)[:, None]
        along = np.stack([np.cos(tilt), np.sin(tilt)], 1)[:, None]
        gap, slip = ((above - below) * normal).sum(2), ((above - below) * along).sum(2)
        area = self.width * np.array(SHARES)
        closed = self.kn * area * np.maximum(-gap, 0.0)
        shear = np.clip(self.ks * area * slip, -FRICTION * closed, FRICTION * closed)
        pressed = closed[..., None] * normal - shear[..., None] * along
        forces = np.zeros((n, 3))
        forces[:, 1] = -self.weight
        _put(forces, lower, pressed)
        _put(forces[:-1], above[1:] - centres[:-1, None], -pressed[1:])
        corner = arms(np.array([-half]), tall, slice(self.pushed, self.pushed + 1))
        push = np.array([[[state[-1] * n * self.weight, 0.0]]])
        _put(forces[self.pushed : self.pushed + 1], corner, push)
        top = arms(np.array([half]), tall - self.held, slice(n - 1, n))
        _put(forces[n - 1 :], top, np.array([[[-SUPPORT * (centres[-1, 0] + top[0, 0, 0] - half), 0.0]]]))
        reached = centres[self.pushed, 0] + corner[0, 0, 0] + half
        return np.append((forces / self.weight / (1.0, 1.0, half)).ravel(), 1e3 * (reached - displacement))


def _put(forces: np.ndarray, arms: np.ndarray, added: np.ndarray) -> None:
    """Forces (n, k, 2) at arms (n, k, 2) onto forces and moments of blocks (n, 3)."""
    forces[:, :2] += added.sum(1)
    forces[:, 2] += (arms[..., 0] * added[..., 1] - arms[..., 1] * added[..., 0]).sum(1)
