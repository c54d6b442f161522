"""Descriptions of the fields for ParaView (VTKHDF): meaning and units of each, float32 or whole numbers."""

from __future__ import annotations

from dem_cli.results.output.layout import CONTACTS, FRAMES, JOINT_PLACES, JOINT_STATES, TURNED, Described

_MEAN_STRESS = "mean stress of the block by all forces on it, tension positive, 0 if it is fixed"
BLOCK_FIELDS = {
    "PointData/displacement": Described("displacement of a corner since the start", "m"),
    "PointData/velocity": Described("velocity of a corner: m/s in a time history, else per solver step", "m/s"),
    "CellData/block_id": Described("number of the block"),
    "CellData/material": Described("number of its material"),
    "CellData/fixed": Described("1: the block cannot move"),
    "CellData/rotation": Described(
        TURNED, "rad", in_space=Described("angle that the block has turned by, from 0 to π", "rad")
    ),
    "CellData/orientation": Described(
        "unit quaternion w, x, y, z of how the block has turned since it was drawn", spatial=True
    ),
    "CellData/angular_velocity": Described(
        "spin of the block along x, y, z: rad/s in a time history, else per solver step", "rad/s", spatial=True
    ),
    "CellData/mean_stress": Described(
        f"{_MEAN_STRESS}: xx, yy, xy", "Pa", in_space=Described(f"{_MEAN_STRESS}: xx, yy, zz, yz, zx, xy", "Pa")
    ),
    "CellData/principal_stress": Described("principal values of mean_stress, largest tension first", "Pa"),
    "CellData/stress": Described(
        FRAMES["stresses"].meaning + ": xx, yy, xy", "Pa",
        in_space=Described(FRAMES["stresses"].meaning + ": xx, yy, zz, yz, zx, xy", "Pa"),
    ),
}  # fmt: skip
CONTACT_FIELDS = {
    "PointData/joint": CONTACTS["joint"],
    "PointData/block_a": Described("number of the first block"),
    "PointData/block_b": Described("number of the second block"),
    "PointData/normal": CONTACTS["normals"],
    "PointData/force": Described("force on block b", "N"),
    "PointData/normal_force": CONTACTS["normal_force"],
    "PointData/shear_force": CONTACTS["shear_force"]._replace(
        in_space=Described("size of the shear force", "N", CONTACTS["shear_force"].axes[:1])
    ),
    "PointData/gap": CONTACTS["gap"],
    "PointData/slip": CONTACTS["slip"],
    "PointData/state": Described("0 open, 1 sticking, 2 sliding"),
}
JOINT_FIELDS = {
    "PointData/gap": Described("distance across the joint at this end, positive open", "m"),
    "CellData/block_a": Described("number of the first block"),
    "CellData/block_b": Described("number of the second block"),
    "CellData/area": JOINT_PLACES["area"],
    **{f"CellData/{name}": said for name, said in JOINT_STATES.items() if name != "state"},
    "CellData/state": Described("0 open, 1 sticking, 2 sliding"),
}
LINK_FIELDS = {
    "PointData/force": Described("axial force, tension positive", "N"),
    "CellData/link": Described("number of the tie or bar, in the order of /dem/links"),
    "CellData/largest_force": Described("largest axial force of it, tension positive", "N"),
}
STEP_FIELDS = {
    "FieldData/load_multiplier": Described("load multiplier λ"),
    "FieldData/control_displacement": Described("largest displacement of any block since the start", "m"),
    "FieldData/stage": FRAMES["stage"],
    "FieldData/step": Described("solver steps so far"),
    "FieldData/time": Described("time since the start of a time history", "s"),
}
VTK_FILES = {  # what each shows, and its fields
    "blocks.vtkhdf": ("blocks, as cells whose corners move", BLOCK_FIELDS),
    "contacts.vtkhdf": ("contact points with their forces", CONTACT_FIELDS),
    "joints.vtkhdf": ("joints as they were drawn, as lines that move with the blocks", JOINT_FIELDS),
    "links.vtkhdf": ("ties and bars, where there are any, as lines that move with the blocks", LINK_FIELDS),
}
