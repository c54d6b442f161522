"""Wall SW100 as an elastic body: how far its beam moves, by blocks of every kind and by finite elements."""

from __future__ import annotations

import numpy as np

from dem_cli.app import api
from dem_cli.case.reader import LoadedCase
from dem_cli.core.contact.compatibility import free_columns, relative_motion, strain_motion
from dem_cli.core.contact.start import bodies_at_rest, joints_of_start
from dem_cli.core.engine.properties import joint_properties
from dem_cli.core.model.model import Model
from dem_cli.core.model.scales import smallest_edge
from dem_cli.masonry.assembly.solver_request import solver_request
from studies.deformable.finite_elements import ElasticWall
from studies.deformable.finite_elements import displacement as by_elements
from studies.deformable.walls import WALL
from studies.solution import from_file

YOUNG, POISSON, HEIGHT, SHEAR = 15.5e9, 0.2, 0.1, 0.417  # of the blocks [Pa, -, m], and ks/kn
ELEMENTS = 0.0125  # size [m]; half of it changes displacements by less than 0.03 %


def stones(deformation: str) -> list[str]:
    """Overrides that make all blocks deform."""
    keys = {"young": YOUNG, "poisson": POISSON, "deformation": repr(deformation)}
    return [f"materials.{name}.{key}={value}" for name in ("sandstone", "concrete") for key, value in keys.items()]


def displacement(ratio: float, deformation: str) -> float:
    """Of the beam per newton of a push that acts evenly in it [m], all joints closed; linear. ratio: kn h/E."""
    kn = ratio * YOUNG / HEIGHT
    law = f"{{law='elastic', kn={kn!r}, ks={SHEAR * kn!r}, points=5}}"
    return compliance(from_file(WALL, f"joints.dry={law}", *stones(deformation)), evenly=True)


def compliance(loaded: LoadedCase, evenly: bool = False) -> float:
    """Work of the live loads per square of them, all joints closed: displacement of a unit load along itself [m/N].

    evenly: loads act over all of their blocks, and do not deform these by themselves.
    """
    from scipy.sparse import coo_array, diags_array
    from scipy.sparse.linalg import spsolve

    model = api.build_model(loaded)
    properties, bodies = joint_properties(solver_request(loaded.case), model), bodies_at_rest(model)
    joints = joints_of_start(model, bodies, properties, smallest_edge(model)).joints
    rows, d, n_dof = relative_motion(joints, model.dimension), model.dimension, model.dead_loads.shape[1]
    columns, total = free_columns(model, joints), n_dof * int((~model.fixed).sum())
    if model.n_modes:  # behind all motions of rigid blocks
        rows = np.concatenate([rows, strain_motion(model, joints, bodies)], axis=3)
        first = np.where(columns[:, :, :1] < 0, -1, total + columns[:, :, :1] // n_dof * model.n_modes)
        columns = np.concatenate([columns, np.where(first < 0, -1, first + np.arange(model.n_modes))], axis=2)
    at = np.broadcast_to(columns[:, None], rows.shape)
    places = np.broadcast_to(np.arange(rows.shape[0] * d).reshape(-1, d, 1, 1), rows.shape)
    used = at >= 0
    stiffness = model.mode_stiffness[~model.fixed].ravel() if model.n_modes else np.zeros(0)
    motion = coo_array((rows[used], (places[used], at[used])), shape=(d * len(rows), total + len(stiffness))).tocsr()
    springs = diags_array(np.column_stack([joints.kn, *[joints.ks] * (d - 1)]).ravel())
    inside = diags_array(np.concatenate([np.zeros(total), stiffness]))
    deforms = model.n_modes and not evenly
    on_modes = model.live_mode_loads[~model.fixed].ravel() if deforms else np.zeros(len(stiffness))
    forces = np.concatenate([model.live_loads[~model.fixed].ravel(), on_modes])
    return float(spsolve((motion.T @ springs @ motion + inside).tocsc(), forces) @ forces)


def finite_elements(ratio: float, size: float = ELEMENTS, degree: int | None = None) -> float:
    """The same of elements of this size [m]: the mean displacement of the beam. degree: as for elements."""
    model, kn = api.build_model(from_file(WALL)), ratio * YOUNG / HEIGHT
    low, high = corners_of(model)
    thickness = float(model.thickness[0])
    wall = ElasticWall(low, high, model.fixed, YOUNG, POISSON, thickness, kn, SHEAR * kn)
    return by_elements(wall, model.block_ids.index("beam"), size, degree=degree)


def corners_of(model: Model) -> tuple[np.ndarray, np.ndarray]:
    """Lower left and upper right corners of rectangular blocks [m], (n, 2) each."""
    places = model.vertices + model.centroids[model.vertex_blocks]
    starts = model.part_starts[:-1]
    return np.minimum.reduceat(places, starts), np.maximum.reduceat(places, starts)
