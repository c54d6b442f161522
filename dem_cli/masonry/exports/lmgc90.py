"""Export an LMGC90 script for pylmgc90 that writes DATBOX and, with the argument `run`, runs the simulation.

Rigid bodies (RBDY3 with POLYR contactors, RBDY2 with POLYG), fixed ones with imposed velocities of zero, the friction
of each pair of materials as IQS_CLB, gravity, forces. Moments are written in the plane alone: in space the components 4
to 6 of RBDY3 are about the axes of inertia that LMGC90 finds, and turn with the body. Calls are those of the examples
of LMGC90 RIGID_3D/arche_plein_ceintre_3D/gen_sample.py, RIGID_3D/Wall_PR/command.py, Pre/wall2D/test_rigid_bricks/
gen_sample.py and of pylmgc90/pre/build_avatar/particles.py. LMGC90 was not at hand: tests read the script back, nobody
has run it there.
"""

from __future__ import annotations

import numpy as np

from dem_cli.masonry.exports.contents import ExportedCase, number, triangles

BODY, SHAPE, ELEMENT = {2: "RBDY2", 3: "RBDY3"}, {2: "POLYG", 3: "POLYR"}, {2: "Rxx2D", 3: "Rxx3D"}
ALERT = 0.02  # of the shortest edge: contact is looked for so far away
MOMENT = 1e-9  # of the largest force, in m: moments that are less are none
TIME_STEP, STEPS = 1e-3, 2000

_HEAD = '''\
"""{title}: {count} blocks, written by dem for LMGC90 (pylmgc90).

    python {file}        writes DATBOX
    python {file} run    and goes through {steps} steps

LAMBDA multiplies the live load: {live}
{notes}Not run by those who wrote it: compare the masses below with those that LMGC90 prints.
"""

import os
import sys

import numpy as np
from pylmgc90 import pre

LAMBDA = 0.0
dim = {dim}

bodies, mats, mods = pre.avatars(), pre.materials(), pre.models()
tacts, svs = pre.tact_behavs(), pre.see_tables()
rigid = pre.model(name="rigid", physics="MECAx", element="{element}", dimension=dim)
mods.addModel(rigid)


def block(parts, material, color, fixed, dead, live):
    """A rigid body of convex parts; forces at its centroid, in 2D with their moment about it."""
    body = pre.avatar(dimension=dim)
    body.addBulk(pre.rigid3d() if dim == 3 else pre.rigid2d())
    body.addNode(pre.node(coor=np.zeros(dim), number=1))
    body.defineGroups()
    body.defineModel(model=rigid)
    body.defineMaterial(material=material)
    for part in parts:
        if dim == 3:
            vertices, faces = np.array(part[0]), np.array(part[1])
            body.addContactors(shape="POLYR", color=color, nb_vertices=len(vertices), vertices=vertices,
                               nb_faces=len(faces), connectivity=faces)
        else:
            vertices = np.array(part)
            body.addContactors(shape="POLYG", color=color, nb_vertices=len(vertices), vertices=vertices)
    body.computeRigidProperties()
    if fixed:
        body.imposeDrivenDof(component=list(range(1, 7 if dim == 3 else 4)), dofty="vlocy")
    else:
        for k, (always, times_lambda) in enumerate(zip(dead, live), 1):
            if always or LAMBDA * times_lambda:
                body.imposeDrivenDof(component=[k], dofty="force", ct=always + LAMBDA * times_lambda)
    bodies.addAvatar(body)


'''

_TAIL = """
os.makedirs("DATBOX", exist_ok=True)
gravity = {gravity} * (np.array({down}) + LAMBDA * np.array({lean}))
pre.writeDatbox(dim, mats, mods, bodies, tacts, svs, gravy=list(gravity))

if "run" in sys.argv[1:]:
    from pylmgc90 import chipy

    chipy.Initialize()
    chipy.checkDirectories()
    if dim == 3:
        chipy.PRPRx_UseCpCundallDetection(500)
        chipy.PRPRx_LowSizeArrayPolyr(40)
        chipy.nlgs_3D_DiagonalResolution()
    chipy.SetDimension(dim, 0 if dim == 3 else 1)
    chipy.TimeEvolution_SetTimeStep({step})
    chipy.Integrator_InitTheta(0.5)
    chipy.ReadDatbox(deformable=False)
    chipy.OpenDisplayFiles()
    chipy.ComputeMass()
    for k in range({steps}):
        chipy.IncrementStep()
        chipy.ComputeFext()
        chipy.ComputeBulk()
        chipy.ComputeFreeVelocity()
        chipy.SelectProxTactors()
        chipy.RecupRloc()
        chipy.ExSolver("Stored_Delassus_Loops         ", "QM/16", 1e-4, 1.0, 50, 500)
        chipy.StockRloc()
        chipy.ComputeDof()
        chipy.UpdateStep()
        chipy.WriteDisplayFiles(100)
    chipy.CloseDisplayFiles()
    chipy.Finalize()
"""


def lmgc90(exported: ExportedCase, file: str) -> tuple[str, list[str]]:
    """Write the LMGC90 script named `file`; also returns what it does not carry."""
    case, notes = exported.case, not_carried(exported)
    live = "weight along " + str(exported.lean.tolist()) if exported.leans else "the live forces of the case"
    head = _HEAD.format(
        title=case.title.replace('"""', "'''").replace("\\", "/"),
        count=len(exported.blocks),
        file=file,
        steps=STEPS,
        live=live,
        notes="".join(f"Not carried over: {note}\n" for note in notes),
        dim=case.dimension,
        element=ELEMENT[case.dimension],
    )
    down = np.zeros(case.dimension)
    down[-1] = -1.0
    tail = _TAIL.format(
        gravity=number(case.gravity), down=down.tolist(), lean=exported.lean.tolist(), step=TIME_STEP, steps=STEPS
    )
    return head + "\n".join([*_materials(exported), *_bodies(exported), *_laws(exported)]) + tail, notes


def not_carried(exported: ExportedCase) -> list[str]:
    """List the joint and analysis properties that rigid bodies with Coulomb friction lack."""
    case = exported.case
    notes = [
        f"joint '{name}': of law '{joint.law}' only its friction" for name, joint in case.joints.items()
        if joint.law != "coulomb" or getattr(joint, "softening", None) or getattr(joint, "profile", None)
    ]  # fmt: skip
    notes += exported.left_out
    notes += ["deformation of blocks (young)"] if exported.deforms else []
    turned = _turned(exported)
    more = f" and {len(turned) - 1} more" if len(turned) > 1 else ""
    notes += [f"moments of forces beside the centroid of '{turned[0]}'{more}"] if turned else []
    notes += ["stiffness of joints: bodies do not overlap in LMGC90"] if _stiff(exported) else []
    return notes


def _turned(exported: ExportedCase) -> list[str]:
    """Warn about free blocks in space on which forces have a moment."""
    if exported.case.dimension == 2:
        return []
    forces = np.abs(np.stack(exported.forces))
    felt = (forces[:, :, 3:] > MOMENT * forces.max()).any(axis=(0, 2))
    return [block.id for block, moment in zip(exported.blocks, felt, strict=True) if moment and not block.fixed]


def _stiff(exported: ExportedCase) -> bool:
    return any(getattr(joint, key, "auto") != "auto" for joint in exported.case.joints.values() for key in ("kn", "ks"))


def _kinds(exported: ExportedCase) -> dict[tuple[str, float], int]:
    """List the LMGC90 materials: those of the case, in the plane one for each thickness."""
    thick = 1.0 if exported.case.dimension == 3 else None
    return {key: k for k, key in enumerate(dict.fromkeys((b.material, thick or b.thickness) for b in exported.blocks))}


def _materials(exported: ExportedCase) -> list[str]:
    lines = []
    for (name, thickness), k in _kinds(exported).items():
        density = exported.case.materials[name].density * thickness
        depth = f", {thickness:g} m deep" if exported.case.dimension == 2 else ""
        call = f'pre.material(name="M{k:04d}", materialType="RIGID", density={number(density)})'
        lines += [f"material_{k} = {call}  # {name}{depth}", f"mats.addMaterial(material_{k})"]
    return [*lines, ""]


def _bodies(exported: ExportedCase) -> list[str]:
    kinds, (dead, live) = _kinds(exported), exported.forces
    lines, written = [], 3  # components: x, y, z, or x, z and the moment
    for k, block in enumerate(exported.blocks):
        kind = kinds[block.material, 1.0 if exported.case.dimension == 3 else block.thickness]
        if exported.case.dimension == 3:
            parts = [(part.vertices.tolist(), (triangles(part) + 1).tolist()) for part in block.parts]
        else:
            parts = [part.tolist() for part in block.parts]
        loads = f"{dead[k, :written].tolist()}, {live[k, :written].tolist()}"
        mass = number(exported.model.masses[k])
        lines.append(f'block({parts}, material_{kind}, "C{kind:04d}", {block.fixed}, {loads})  # {block.id}, {mass} kg')
    return [*lines, ""]


def _laws(exported: ExportedCase) -> list[str]:
    """Write a contact law for each joint, and the pairs of colours that interact."""
    case, dim = exported.case, exported.case.dimension
    lines, laws = [], {}
    for k, (name, joint) in enumerate(case.joints.items()):
        fric = number(getattr(joint, "coefficient", 0.0))
        laws[name] = f"law_{k}"
        call = f'pre.tact_behav(name="iqs{k:02d}", law="IQS_CLB", fric={fric})'
        lines += [f"law_{k} = {call}  # {name}", f"tacts.addBehav(law_{k})"]
    alert = number(float(f"{ALERT * exported.model.shapes.edges.min():.3g}"))
    kinds = list(_kinds(exported).items())
    for (one, _), i in kinds:
        for (other, _), j in kinds[i:]:
            sees = f'CorpsCandidat="{BODY[dim]}", candidat="{SHAPE[dim]}", colorCandidat="C{i:04d}"'
            seen = f'CorpsAntagoniste="{BODY[dim]}", antagoniste="{SHAPE[dim]}", colorAntagoniste="C{j:04d}"'
            law = laws[case.joint_between(one, other)]
            lines.append(f"svs.addSeeTable(pre.see_table({sees}, {seen}, behav={law}, alert={alert}))")
    return lines
