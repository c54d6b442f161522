"""Export a 3DEC data file (Itasca, version 7 and later) that builds blocks, joints, supports and gravity.

Commands as the manual of 3DEC 7.0 has them: `block create polyhedron` (faces clockwise seen from outside, & goes on
in the next line: Creating Single Blocks), `block property`, `block fix`, `block contact generate-subcontacts`, `block
contact jmodel assign mohr`, `block contact property` and `material-table`, `model gravity`, `model solve`; used that
way for masonry by compas_3dec. 3DEC was not at hand: tests read the file back, nobody has run it there.
"""

from __future__ import annotations

import math

import numpy as np

from dem_cli.masonry.exports.contents import ExportedBlock, ExportedCase, number, triple

AUTO_STIFFNESS = 1e4  # kn times the size of a block over its mean pressure under its own weight


def itasca_3dec(exported: ExportedCase) -> tuple[str, list[str]]:
    """Write the 3DEC data file; also returns what it does not carry."""
    case, notes = exported.case, not_carried(exported)
    lines = [f"; {case.title}: {len(exported.solids)} blocks, written by dem for 3DEC 7"]
    lines += ["; Not run by those who wrote it: compare its masses with those that `dem check` prints."]
    lines += [f"; Not carried over: {note}" for note in notes]
    lines += ["model new", "model large-strain on", ""]
    for block in exported.solids:
        lines += _block(block)
    lines += ["", *_properties(exported), "", *_joints(exported), "", *_gravity(exported)]
    return "\n".join(lines) + "\n", notes


def not_carried(exported: ExportedCase) -> list[str]:
    """List the forces, compounds and joint properties that the 3DEC file does not carry."""
    case = exported.case
    known = ("coulomb", "mohr-coulomb")
    notes = [
        f"joint '{name}': of law '{joint.law}' only stiffness and friction" for name, joint in case.joints.items()
        if joint.law not in known or getattr(joint, "softening", None) or getattr(joint, "profile", None)
    ]  # fmt: skip
    dead, live = exported.forces
    notes += ["forces on blocks (block apply)"] if (dead != 0.0).any() or (live != 0.0).any() else []
    compound = [block.name for block in exported.solids if len(block.parts) > 1]
    more = f" and {len(compound) - 1} more" if len(compound) > 1 else ""
    notes += [f"that the parts of '{compound[0]}'{more} move as one (block join)"] if compound else []
    notes += ["deformation of blocks (young)"] if exported.deforms else []
    return notes + exported.left_out


def _block(block: ExportedBlock) -> list[str]:
    lines = []
    for part in block.parts:
        lines.append(f"block create polyhedron group {_quoted(block.name)} slot 'dem-name' &")
        faces = [" ".join(triple(corner, ",") for corner in part.vertices[loop[::-1]]) for loop in part.faces]
        lines += [f"  face {face} &" for face in faces[:-1]] + [f"  face {faces[-1]}"]
        named = f"range group {_quoted(block.name)} slot 'dem-name'"
    lines.append(f"block group {_quoted(block.material)} slot 'dem-material' {named}")
    return [*lines, f"block fix {named}"] if block.fixed else lines


def _quoted(name: str) -> str:
    """Quote a name for 3DEC, replacing apostrophes."""
    return "'" + name.replace("'", "_") + "'"


def _properties(exported: ExportedCase) -> list[str]:
    return [
        f"block property density {number(material.density)} range group {_quoted(name)} slot 'dem-material'"
        for name, material in exported.case.materials.items()
        if any(block.material == name for block in exported.blocks)
    ]


def _joints(exported: ExportedCase) -> list[str]:
    """Write the properties of the first joint for all contacts, then those of each pair of materials."""
    case = exported.case
    names = [name for name in case.materials if any(block.material == name for block in exported.blocks)]
    default = next(iter(case.joints))
    lines = ["block contact generate-subcontacts", "block contact jmodel assign mohr"]
    lines += [f"block contact property {_values(exported, default)}  ; {default}"]
    lines += [f"block contact material-table default property {_values(exported, default)}"]
    for i, one in enumerate(names):
        for other in names[i:]:
            joint = case.joint_between(one, other)
            if joint != default:
                between = f"group-intersection {_quoted(one)} {_quoted(other)}"
                lines.append(f"block contact property {_values(exported, joint)} range {between}  ; {joint}")
    return lines


def _values(exported: ExportedCase, name: str) -> str:
    joint = exported.case.joints[name]
    automatic = _automatic(exported)
    kn = automatic if getattr(joint, "kn", "auto") == "auto" else joint.kn
    ks = kn if getattr(joint, "ks", "auto") == "auto" else joint.ks
    friction = math.degrees(math.atan(getattr(joint, "coefficient", 0.0)))
    values = {"stiffness-normal": kn, "stiffness-shear": ks, "friction": friction}
    values["cohesion"] = getattr(joint, "cohesion", None) or 0.0
    values["tension"] = getattr(joint, "tension", None) or 0.0
    return " ".join(f"{key} {number(value)}" for key, value in values.items())


def _automatic(exported: ExportedCase) -> float:
    """Choose a stiffness for kn = "auto" [Pa/m] such that a block sinks by 1e-4 of its size under self-weight,
    rounded.
    """
    density = np.median([exported.case.materials[block.material].density for block in exported.blocks])
    return float(f"{AUTO_STIFFNESS * exported.case.gravity * float(density):.2g}")


def _gravity(exported: ExportedCase) -> list[str]:
    case = exported.case
    lean = exported.lean if case.dimension == 3 else np.array([exported.lean[0], 0.0, exported.lean[1]])
    down = np.array([0.0, 0.0, -case.gravity])
    lines = ["; [load] times the weight acts sideways" if exported.leans else "; gravity alone"]
    lines += [f"model gravity {triple(down)}", "block mechanical damping local 0.8", "model solve ratio-local 1e-6"]
    if exported.leans:
        push = [f"[{number(d)} + load * {number(case.gravity * along)}]" for d, along in zip(down, lean)]
        lines += ["", "; to push: raise load until `model solve` finds no rest", "; [global load = 0.1]"]
        lines += [f"; model gravity {' '.join(push)}", "; model solve ratio-local 1e-6"]
    return lines
