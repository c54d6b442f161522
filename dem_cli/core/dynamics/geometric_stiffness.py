"""Geometric stiffness: change of contact forces that turn and shift when the blocks between them move.

In space: spatial_stiffness.py. In the plane:

A force f along a direction e of the contact frame (normal or tangent) does work on e · (c − x), where c is a corner
of one block and e turns with the edge of the other, whose centroid is x. With A, B: arms of the point from the
centroids of a and b, e' = e turned by +90°, the second derivatives of that distance are, for an edge of a,

    (θa, xa) −e'    (θa, xb) e'    (θa, θa) −e · A    (θa, θb) e · B    (θb, θb) −e · B

and for an edge of b the same with a and b exchanged and the opposite sign. Their sum times −f is what has to be added
to the stiffness of the springs. The joints of planar_geometry.py turn the normal with both edges where corners meet,
and so does this; the period of blocks that are 0 to 1 % of an edge apart is that of the engine to 3e-5.
"""

from __future__ import annotations

from typing import TYPE_CHECKING

import numpy as np

from dem_cli.core.contact.compatibility import directions, free_columns
from dem_cli.core.contact.joints import JointGeometry
from dem_cli.core.contact.planar import corner_shares
from dem_cli.core.dynamics.spatial_stiffness import attachment, second_derivatives
from dem_cli.core.geometry.rotation import across

if TYPE_CHECKING:
    from collections.abc import Callable

    from scipy.sparse import csr_array

    from dem_cli.core.kernels.records import Bodies, Contacts, Joints, PlanarGeometry
    from dem_cli.core.model.model import Model


def geometric_stiffness(
    model: Model, joints: Joints, geometry: JointGeometry, contacts: Contacts, bodies: Bodies
) -> csr_array:
    """Assemble the geometric stiffness [N/m, N, N m], (n_free, n_free), symmetric; frames and points must be
    current."""
    from scipy.sparse import coo_array

    local = SECOND_DERIVATIVES[model.dimension](model, joints, geometry, contacts, bodies)
    dofs = free_columns(model, joints).reshape(len(local), 2 * model.dead_loads.shape[1])
    rows, columns = np.broadcast_arrays(dofs[:, :, None], dofs[:, None, :])
    used = (rows >= 0) & (columns >= 0)
    n = model.dead_loads.shape[1] * int((~model.fixed).sum())
    return coo_array((-local[used], (rows[used], columns[used])), shape=(n, n)).tocsr()


def _in_plane(model: Model, joints: Joints, geometry: PlanarGeometry, contacts: Contacts, bodies: Bodies) -> np.ndarray:
    """Second derivatives times forces in the plane, (n_points, 6, 6): x, y, θ of a, then of b."""
    blocks = joints.blocks[joints.owners]
    frames = directions(joints, 2)
    forces = np.column_stack([contacts.normal, contacts.shear])
    along = np.einsum("pd,pdk->pk", forces, frames)  # force on b [N], (n_points, 2)
    normal = across(along)
    share = corner_shares(joints, geometry, bodies.corners)[:, None]
    arms = joints.points[:, None] - bodies.positions[blocks]
    lever_a, lever_b = np.einsum("pk,psk->sp", along, arms)
    one, two = share[:, 0], 1.0 - share[:, 0]
    local = np.zeros((len(blocks), 6, 6))
    for k in (0, 1):
        local[:, 2, k], local[:, 2, 3 + k] = -one * normal[:, k], one * normal[:, k]
        local[:, 5, k], local[:, 5, 3 + k] = -two * normal[:, k], two * normal[:, k]
    local[:, 2, 5] = one * lever_b - two * lever_a
    local += local.swapaxes(1, 2)
    local[:, 2, 2], local[:, 5, 5] = (two - one) * lever_a, (two - one) * lever_b
    return local


def _in_space(model: Model, joints: Joints, geometry: JointGeometry, contacts: Contacts, bodies: Bodies) -> np.ndarray:
    """Second derivatives times forces in space, (n_points, 12, 12): x, rotation vector of a, then of b."""
    forces = np.column_stack([contacts.normal, contacts.shear])
    along = np.einsum("pd,pdk->pk", forces, directions(joints, 3))
    arms = joints.points[:, None] - bodies.positions[joints.blocks[joints.owners]]
    return second_derivatives(along, arms, attachment(model, joints, geometry, contacts, bodies))


SECOND_DERIVATIVES: dict[int, Callable[..., np.ndarray]] = {2: _in_plane, 3: _in_space}
