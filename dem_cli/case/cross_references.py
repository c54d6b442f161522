"""Cross-references between the tables of a case: names that may be left out are filled in, the rest is checked.

They work on the tables as read, so that slips are reported along with the validator's.
"""

from __future__ import annotations

from collections.abc import Iterator
from typing import Any

from dem_cli.analysis_kinds import kind_of
from dem_cli.case.base import NOTHING
from dem_cli.case.wording import either, show, unknown_name
from dem_cli.errors import CaseProblem, KeyPath, dotted

ONE_OR_MORE = ("motion", "reference")  # one table, or several in a list
SELECTING = (  # that select blocks
    "imperfection", "load", "pressure", "fill", "strain", "restraint", "settlement", "initial", "monitor"
)  # fmt: skip
LINKS = ("tie", "reinforcement")
REACTIONS = ("reaction", "reaction_moment")  # quantities of monitors of what holds blocks
OF_CUTS = ("normal_force", "shear_force", "moment", "shear_force_across", "moment_across", "torsion")  # and of cuts
WITH_LIVE_LOADS = ("load", "pressure")


def complete(data: dict[str, Any], title: str) -> None:
    """Fill in, in place, the title, the only material and the ids of structures; a single table becomes a list."""
    if data.get("title", "") == "":
        data["title"] = title
    for key in ONE_OR_MORE:
        if isinstance(data.get(key), dict):
            data[key] = [data[key]]
    materials = data.get("materials")
    only = next(iter(materials)) if isinstance(materials, dict) and len(materials) == 1 else ""
    tables = [table for _, table in entries(data, "structure")]
    taken = {table.get("id") for table in tables if isinstance(table.get("id", 0), str)}
    ground = [data["ground"]] if isinstance(data.get("ground"), dict) else []
    for table in tables + [table for _, table in entries(data, "block")] + ground:
        if only and table.get("material", "") == "":
            table["material"] = only
    for table in tables:
        kind = table.get("kind")
        if table.get("id", "") == "" and isinstance(kind, str):
            number = 1
            while (name := kind if number == 1 else f"{kind}{number}") in taken:
                number += 1
            table["id"] = name
            taken.add(name)


def problems(data: dict[str, Any]) -> list[CaseProblem]:
    """List unknown and doubled names in a case, and report a case without blocks."""
    found = [*unknown_materials(data), *unknown_in_interfaces(data), *unknown_structures(data)]
    found += [*unknown_bars(data), *odd_cracks(data), *odd_heads(data)]
    for key in ("structure", "block"):
        seen: dict[str, KeyPath] = {}
        for path, table in entries(data, key):
            name = table.get("id")
            if isinstance(name, str) and name in seen:
                message = f"{show(name)} is used twice, first at {dotted(seen[name])}"
                found.append(CaseProblem((*path, "id"), message))
            elif isinstance(name, str):
                seen[name] = (*path, "id")
    analysis = data["analysis"] if isinstance(data.get("analysis"), dict) else {}
    loads = [table for key in WITH_LIVE_LOADS for _, table in entries(data, key)]
    if analysis.get("pattern") == "live" and not any(table.get("kind") == "live" for table in loads):
        found.append(CaseProblem(("analysis", "pattern"), "'live' needs a [[load]] or [[pressure]] with kind = 'live'"))
    if analysis.get("kind") == "settlement" and not data.get("settlement"):
        found.append(CaseProblem(("analysis", "kind"), "'settlement' needs a [[settlement]]"))
    found += [*strained_blocks(data), *controlled_monitor(data, analysis.get("of"))]
    found += [*reactions_in_time(data, analysis.get("kind")), *following_loads(data, analysis)]
    found += weightless_joints(data, analysis.get("kind"))
    if not data.get("structure") and not data.get("block"):
        found.append(CaseProblem((), "no blocks: the case needs a [[structure]] or a [[block]]"))
    return found


def controlled_monitor(data: dict[str, Any], name: object) -> Iterator[CaseProblem]:
    """Report a monitor named by analysis.of that does not exist or does not measure a signed displacement."""
    if not isinstance(name, str):
        return
    monitors = [(path, table) for path, table in entries(data, "monitor") if isinstance(table.get("name"), str)]
    named = [found for found in monitors if found[1]["name"] == name]
    if not named:
        hint = unknown_name("monitor", name, [table["name"] for _, table in monitors])
        hint = hint if monitors else f"{show(name)} is no name of a [[monitor]]: give one a name"
        yield CaseProblem(("analysis", "of"), hint)
    for path, table in named:
        if table.get("quantity", "displacement") != "displacement":
            message = f"{show(table['quantity'])} cannot be controlled (analysis.of): only 'displacement' can"
            yield CaseProblem((*path, "quantity"), message)
        elif "component" not in table:
            yield CaseProblem((*path, "component"), "missing; analysis.of controls a displacement with a sign")


def reactions_in_time(data: dict[str, Any], kind: object) -> list[CaseProblem]:
    """Report reaction monitors in analyses with real masses, and cut monitors in a modal analysis."""
    if not kind_of(kind).real_masses:
        return []
    refused = REACTIONS if kind_of(kind).shakes else (*REACTIONS, *OF_CUTS)
    asked = [(path, table.get("quantity")) for path, table in entries(data, "monitor")]
    message = f"is not known in kind = {show(kind)}: only analyses without time follow such forces"
    return [
        CaseProblem((*path, "quantity"), f"{show(quantity)} {message}")
        for path, quantity in asked
        if quantity in refused
    ]


def weightless_joints(data: dict[str, Any], kind: object) -> Iterator[CaseProblem]:
    """Report joints of a time history whose stiffness is scaled by block weights that are zero."""
    gravity, joints = data.get("gravity"), data.get("joints")
    if not kind_of(kind).shakes or isinstance(gravity, bool) or gravity != 0 or not isinstance(joints, dict):
        return
    for name, joint in joints.items():
        if isinstance(joint, dict) and joint.get("kn", "auto") == "auto":
            where = f"0 is not allowed in kind = {show(kind)} where joints.{name}.kn is 'auto'"
            message = f"{where}, which goes by the weights of blocks; give kn [Pa/m]"
            yield CaseProblem(("gravity",), message)
            return


def following_loads(data: dict[str, Any], analysis: dict[str, Any]) -> Iterator[CaseProblem]:
    """Report follower loads where they are not supported: with real masses, and as the load of displacement control."""
    for path, table in entries(data, "load"):
        kind, follows = analysis.get("kind"), table.get("follows")
        if follows is not None and kind_of(kind).real_masses:
            where = f"{show(follows)} is not known in kind = {show(kind)}"
            yield CaseProblem((*path, "follows"), f"{where}: loads follow blocks in analyses without time")
        lone = analysis.get("control") == "displacement" and "of" not in analysis
        if follows == "block" and lone and table.get("kind") == "live":
            message = (
                "'block' is not allowed with control = 'displacement' unless analysis.of names a monitor: along a "
                "direction that turns there is no displacement to go to; 'point' is"
            )
            yield CaseProblem((*path, "follows"), message)


def strained_blocks(data: dict[str, Any]) -> Iterator[CaseProblem]:
    """Report deformable blocks where not supported: beside ties and bars, bending in 3D, joints with too few points."""
    materials = data.get("materials")
    if not isinstance(materials, dict):
        return
    held = next((key for key in LINKS if data.get(key)), None)
    reason = f"beside [[{held}]], which holds on to blocks that keep their shape" if held else ""
    for name, table in materials.items():
        way = table.get("deformation") if isinstance(table, dict) else None
        path = ("materials", name, "deformation")
        if way not in ("uniform-strain", "quadratic"):
            continue
        if reason:
            yield CaseProblem(path, f"{show(way)} is not known {reason}")
        elif way == "quadratic" and data.get("dimension") == 3:
            yield CaseProblem(path, "'quadratic' is not known in 3D; 'uniform-strain' and 'joints' are")
        elif way == "quadratic":
            yield from _unbent_joints(data)


def _unbent_joints(data: dict[str, Any]) -> Iterator[CaseProblem]:
    """Yield the names of joints whose contact points are too few for blocks that bend."""
    joints = data.get("joints")
    for name, joint in joints.items() if isinstance(joints, dict) else ():
        if isinstance(joint, dict) and joint.get("points") in (2, "vertices"):
            message = f"{show(joint['points'])} is too few beside deformation = 'quadratic'; must be 3 to 9, best 5"
            yield CaseProblem(("joints", name, "points"), message)
        if isinstance(joint, dict) and joint.get("profile") is not None:
            yield CaseProblem(("joints", name, "profile"), "not allowed beside deformation = 'quadratic'")


def unknown_materials(data: dict[str, Any]) -> Iterator[CaseProblem]:
    """Report unknown materials in structures, blocks and the ground, and missing ones where there are several."""
    materials = names(data, "materials")
    ground: list[tuple[KeyPath, dict[str, Any]]] = []
    if isinstance(data.get("ground"), dict):
        ground = [(("ground",), data["ground"])]
    for of_key in (entries(data, "structure"), entries(data, "block"), ground):
        for path, table in of_key:
            if materials and table.get("material", "") == "":
                yield CaseProblem((*path, "material"), f"missing; must be {either(materials)}")
            for place, name in mentions(table, path):
                if materials and name not in materials:
                    yield CaseProblem(place, unknown_name("material", name, materials))


def mentions(value: Any, path: KeyPath) -> Iterator[tuple[KeyPath, str]]:
    """Find every key `material` at any depth of a case, with its key path and value."""
    if isinstance(value, dict):
        for key, item in value.items():
            if key == "material" and isinstance(item, str) and item:
                yield (*path, key), item
            else:
                yield from mentions(item, (*path, key))
    elif isinstance(value, list) and value and isinstance(value[0], dict):
        for i, item in enumerate(value):
            yield from mentions(item, (*path, i))


def unknown_in_interfaces(data: dict[str, Any]) -> Iterator[CaseProblem]:
    """Report materials and joints of [[interface]] tables that do not exist."""
    materials, joints = names(data, "materials"), names(data, "joints")
    for path, table in entries(data, "interface"):
        between = table.get("between")
        for i, name in enumerate(between if isinstance(between, list) else ()):
            if isinstance(name, str) and name not in materials:
                yield CaseProblem((*path, "between", i), unknown_name("material", name, materials))
        joint = table.get("joint")
        if isinstance(joint, str) and joint not in joints:
            yield CaseProblem((*path, "joint"), unknown_name("joint", joint, joints))


def unknown_bars(data: dict[str, Any]) -> Iterator[CaseProblem]:
    """Report bars of [[reinforcement]] tables that do not exist."""
    known = names(data, "bars")
    for path, table in entries(data, "reinforcement"):
        name = table.get("bar")
        if isinstance(name, str) and name not in known:
            yield CaseProblem((*path, "bar"), unknown_name("bar", name, known))


def odd_cracks(data: dict[str, Any]) -> Iterator[CaseProblem]:
    """Report unknown joints inside cracked stones, and cracks beside [[imperfection]], not known together."""
    joints = names(data, "joints")
    for path, table in entries(data, "structure"):
        crack, place = table.get("crack"), (*path, "crack")
        if isinstance(crack, dict):
            crack, place = crack.get("joint"), (*place, "joint")
        if isinstance(crack, str) and crack not in joints:
            yield CaseProblem(place, unknown_name("joint", crack, joints))
        elif crack is not None and data.get("imperfection"):
            yield CaseProblem(
                (*path, "crack"),
                "not known beside [[imperfection]]: the pieces of a stone would get errors each its own",
            )


def odd_heads(data: dict[str, Any]) -> Iterator[CaseProblem]:
    """Report head joints that do not exist, name themselves, or have head joints in turn."""
    tables = data.get("joints")
    heads = {
        name: table["head"]
        for name, table in (tables.items() if isinstance(tables, dict) else ())
        if isinstance(table, dict) and isinstance(table.get("head"), str)
    }
    known = names(data, "joints")
    for name, head in heads.items():
        path = ("joints", name, "head")
        if head == NOTHING and NOTHING in known:
            yield CaseProblem(path, f"{show(head)} means both no joint and [joints.{NOTHING}]: give that another name")
        elif head == NOTHING:
            continue
        elif head not in known:
            others = [other for other in known if other != name]
            yield CaseProblem(path, unknown_name("joint", head, [*others, NOTHING]))
        elif head == name:
            yield CaseProblem(path, f"{show(head)} is the joint itself; leave 'head' out where heads are like beds")
        elif head in heads:
            message = f"{show(head)} has a 'head' of its own ({show(heads[head])}): what lies in head joints has none"
            yield CaseProblem(path, message)


def unknown_structures(data: dict[str, Any]) -> Iterator[CaseProblem]:
    """Report tables that select blocks of a structure that does not exist."""
    ids = [table["id"] for _, table in entries(data, "structure") if isinstance(table.get("id"), str)]
    for path, table in [found for key in SELECTING for found in entries(data, key)] + _group_members(data):
        name = table.get("structure")
        if isinstance(name, str) and name not in ids:
            yield CaseProblem((*path, "structure"), unknown_name("structure", name, ids))


def _group_members(data: dict[str, Any]) -> list[tuple[KeyPath, dict[str, Any]]]:
    """List the tables inside [groups] with their key paths."""
    groups = data.get("groups")
    members = (
        [(name, many) for name, many in groups.items() if isinstance(many, list)] if isinstance(groups, dict) else ()
    )
    return [(("groups", name, k), one) for name, many in members for k, one in enumerate(many) if isinstance(one, dict)]


def entries(data: dict[str, Any], key: str) -> list[tuple[KeyPath, dict[str, Any]]]:
    """List the tables of an array of tables with their key paths; other items are left to the validator."""
    tables = data.get(key)
    pairs = enumerate(tables) if isinstance(tables, list) else ()
    return [((key, i), table) for i, table in pairs if isinstance(table, dict)]


def names(data: dict[str, Any], key: str) -> list[str]:
    """List the keys of a table of tables; empty where it is no table."""
    table = data.get(key)
    return list(table) if isinstance(table, dict) else []
