"""Contact points between two rigid blocks that move in space, one by one and in plain words: forces on both blocks.

A point is a corner of b on a face of a, a corner of a on a face of b, or the crossing of an edge of a with one of b;
its normal is that of the face or of both edges, or where corners meet half of either. Shear follows a direction that
is fixed in a, made square to the normal; slip is summed over the steps of a motion. Blocks are given by place and
rotation vector. Nothing of the program is used.
"""

from __future__ import annotations

from dataclasses import dataclass

import numpy as np
from scipy.spatial.transform import Rotation

FACE_OF_A, FACE_OF_B, CROSSING, BOTH = "face of a", "face of b", "crossing", "both"


@dataclass
class ContactPoint:
    """At rest both blocks are unturned, with their centroids at 0 (a) and `apart` (b)."""

    kind: str
    place: np.ndarray  # at rest, (3,)
    normal: np.ndarray  # from a to b, unit
    tangent: np.ndarray  # fixed in a, square to the normal
    apart: np.ndarray  # centroid of b at rest
    kn: float
    ks: float
    pressed: float  # overlap at rest [m]
    slip: np.ndarray  # at rest, along both tangents [m]
    edges: tuple[np.ndarray, np.ndarray] = (np.zeros(3), np.zeros(3))  # directions of those that cross

    def forces(self, motion: np.ndarray, steps: int = 2) -> np.ndarray:
        """On a and b with moments about their centroids, (12,), after a motion from rest: x, rotation of a, then b."""
        slip = self.slip.copy()
        for k in range(steps):
            before, after = (self._state(motion * share) for share in (k / steps, (k + 1) / steps))
            middle = self._state(motion * ((k + 0.5) / steps))
            place_a = Rotation.from_rotvec(motion[3:6] * ((k + 0.5) / steps)).inv().apply(middle.place - middle.at[0])
            place_b = Rotation.from_rotvec(motion[9:] * ((k + 0.5) / steps)).inv().apply(middle.place - middle.at[1])
            went = [
                end.at[side] + end.turn[side].apply(place) - start.at[side] - start.turn[side].apply(place)
                for side, place in ((0, place_a), (1, place_b))
                for start, end in [(before, after)]
            ]
            relative = went[1] - went[0]
            slip += [relative @ middle.tangents[0], relative @ middle.tangents[1]]
        end = self._state(motion)
        force = self.kn * (self.pressed - end.opened) * end.normal
        force = force - self.ks * (slip[0] * end.tangents[0] + slip[1] * end.tangents[1])
        arms = [end.place - at for at in end.at]
        return np.concatenate([-force, -np.cross(arms[0], force), force, np.cross(arms[1], force)])

    def _state(self, motion: np.ndarray) -> _State:
        """Where the point is, its normal and tangents, and how far the joint has opened there."""
        at = [motion[:3], self.apart + motion[6:9]]
        turn = [Rotation.from_rotvec(motion[3:6]), Rotation.from_rotvec(motion[9:])]
        of_a = at[0] + turn[0].apply(self.place)
        of_b = at[1] + turn[1].apply(self.place - self.apart)
        normals = [one.apply(self.normal) for one in turn]
        if self.kind == CROSSING:
            along = [one.apply(edge) for one, edge in zip(turn, self.edges)]
            across = np.cross(*along)
            normal = across / np.linalg.norm(across) * np.sign(across @ self.normal)
            opened = (of_b - of_a) @ normal
            share = np.cross(of_b - of_a, along[1]) @ across / (across @ across)
            place = of_a + share * along[0]
        elif self.kind == FACE_OF_B:
            normal, opened, place = normals[1], (of_b - of_a) @ normals[1], of_a
        elif self.kind == FACE_OF_A:
            normal, opened, place = normals[0], (of_b - of_a) @ normals[0], of_b
        else:
            normal = (normals[0] + normals[1]) / np.linalg.norm(normals[0] + normals[1])
            opened, place = (of_b - of_a) @ normal, 0.5 * (of_a + of_b)
        along = turn[0].apply(self.tangent)
        tangent = along - (along @ normal) * normal
        tangent /= np.linalg.norm(tangent)
        return _State(at, turn, place, normal, (tangent, np.cross(normal, tangent)), float(opened))


@dataclass
class _State:
    at: list[np.ndarray]
    turn: list[Rotation]
    place: np.ndarray
    normal: np.ndarray
    tangents: tuple[np.ndarray, np.ndarray]
    opened: float
