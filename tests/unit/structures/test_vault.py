"""Vaults: volumes and faces in the open in closed form, symmetry to the last bit, names, what is refused, gravity."""

from __future__ import annotations

import numpy as np
import pytest
from pydantic import ValidationError
from synthetic.skins import free_volume, model_of, open_area

from dem_cli.case.base import KeyProblem
from dem_cli.masonry.structures.arch import SHAPE_JOINTS, Arch
from dem_cli.masonry.structures.vaults import shapes
from dem_cli.masonry.structures.vaults.table import Vault

DOME = {"shape": "dome", "radius": 5.0, "thickness": 0.4, "courses": 6, "per_course": 12}
BARREL = {"shape": "barrel", "span": 4.0, "length": 6.0, "thickness": 0.4, "voussoirs": 9, "rows": 4}
GROIN = {"shape": "groin", "span": 4.0, "thickness": 0.4, "voussoirs": 9, "rows": 4}
DOMES = {
    "hemisphere": DOME,
    "rings of aligned stones": DOME | {"bond": "stack", "oculus_radius": 0.8},
    "fewer stones towards the crown": DOME | {"per_course": [24, 24, 12, 12, 6, 6], "springing_deg": 60.0},
    "lantern ring closed": DOME | {"oculus_deg": 12.0, "cap": True, "facets": 48},
}
BARRELS = {
    "semicircle": BARREL,
    "rings side by side": BARREL | {"offset": 0.0},
    "segment": BARREL | {"rise": 0.8, "offset": 0.4},
    "pointed": BARREL | {"rise": 3.0, "voussoirs": 10},
    "angle": BARREL | {"included_angle_deg": 100.0, "rows": 1},
}
GROINS = {
    "square": GROIN,
    "keystones meet at a joint": GROIN | {"voussoirs": 10, "rows": 6},
    "mitred": GROIN | {"groins": "mitred"},
    "oblong, segmental": GROIN | {"length": 5.0, "included_angle_deg": 120.0, "rows": 5},
    "pointed": GROIN | {"rise": 2.5, "voussoirs": 8},
}
CLOISTER = GROIN | {"shape": "cloister"}
CLOISTERS = {name: keys | {"shape": "cloister"} for name, keys in GROINS.items()}


def vault(**keys) -> dict:
    return {"kind": "vault", "base": False, **keys}


def names(**keys) -> list[str]:
    return [block.id for block in shapes.build(Vault.model_validate({"base": True, **keys}))]


def dome_angles(keys: dict) -> np.ndarray:
    """Bed joints from the crown [rad]."""
    courses, springing = keys["courses"], np.radians(keys.get("springing_deg", 90.0))
    top = springing / (2 * courses + 1)
    if "oculus_radius" in keys:
        top = np.arcsin(keys["oculus_radius"] / (keys["radius"] - keys["thickness"] / 2.0))
    if "oculus_deg" in keys:
        top = np.radians(keys["oculus_deg"])
    return springing + (top - springing) * np.arange(courses + 1) / courses


@pytest.mark.parametrize("keys", DOMES.values(), ids=DOMES)
def test_a_dome_is_the_solid_between_two_polyhedra_on_spheres(keys):
    """Pyramids from the centre over trapezia with corners on a sphere: N/6 sin 2β (sin θ + sin θ') sin(θ − θ')."""
    model = model_of(vault(**keys))
    most = keys["per_course"] if isinstance(keys["per_course"], int) else max(keys["per_course"])
    n = keys.get("facets", most * (1 if keys.get("bond") == "stack" else 2))
    beta, theta = np.pi / n, dome_angles(keys)
    inner, outer = keys["radius"] - keys["thickness"] / 2.0, keys["radius"] + keys["thickness"] / 2.0
    sines = np.sin(theta[:-1]) + np.sin(theta[1:])
    unit = n / 6.0 * np.sin(2.0 * beta) * (sines * np.sin(theta[:-1] - theta[1:])).sum()
    middles = np.stack([np.sin(theta) * np.cos(beta), np.cos(theta)], axis=1)
    slants = np.linalg.norm(np.diff(middles, axis=0), axis=1)
    skin = (inner**2 + outer**2) * n * (np.sin(beta) * sines * slants).sum()
    rim, crown = (n / 2.0 * np.sin(2.0 * beta) * np.sin(theta[k]) ** 2 for k in (0, -1))
    bed = n * np.sin(beta) * np.sqrt(np.cos(theta) ** 2 + (np.sin(theta) * np.cos(beta)) ** 2) * np.sin(theta)
    beds = (outer**2 - inner**2) * bed
    if keys.get("cap", "oculus_radius" not in keys):
        unit += crown * np.cos(theta[-1]) / 3.0
        skin += (inner**2 + outer**2) * crown
        beds[-1] = 0.0
    assert rim > crown
    assert free_volume(model) == pytest.approx(unit * (outer**3 - inner**3), rel=1e-12)
    assert open_area(model) == pytest.approx(skin + beds[0] + beds[-1], rel=1e-9)


@pytest.mark.parametrize("keys", BARRELS.values(), ids=BARRELS)
def test_a_barrel_is_the_prism_over_its_arch(keys):
    model = model_of(vault(**keys))
    area, inner, outer, springing = section(keys)
    length = keys["length"]
    assert free_volume(model) == pytest.approx(area * length, rel=1e-12)
    assert open_area(model) == pytest.approx((inner + outer + 2.0 * springing) * length + 2.0 * area, rel=1e-9)


def arch_joints(keys: dict) -> np.ndarray:
    """Joints of the arch that is the section, from the generator of arches."""
    given = {"voussoirs": keys["voussoirs"], "ring": keys["thickness"]}
    if "included_angle_deg" in keys:
        angle = keys["included_angle_deg"]
        radius = keys["span"] / 2.0 / float(np.sin(np.radians(angle / 2.0)))
        given |= {"included_angle_deg": angle, "inner_radius": radius}
    elif "rise" in keys:
        shape = "pointed" if keys["rise"] > keys["span"] / 2.0 else "segmental"
        given |= {"shape": shape, "span": keys["span"], "rise": keys["rise"]}
    else:
        given |= {"inner_radius": keys["span"] / 2.0}
    arch = Arch.model_validate(given)
    return SHAPE_JOINTS[arch.shape](arch)


def section(keys: dict) -> tuple[float, float, float, float]:
    """Area of a ring of voussoirs, lengths of its inner and outer face and of a springing."""
    joints = arch_joints(keys)
    diagonals = joints[1:, 1] - joints[:-1, 0], joints[:-1, 1] - joints[1:, 0]
    area = 0.5 * np.abs(diagonals[0][:, 0] * diagonals[1][:, 1] - diagonals[0][:, 1] * diagonals[1][:, 0]).sum()
    lengths = np.linalg.norm(np.diff(joints, axis=0), axis=2).sum(axis=0)
    return float(area), *map(float, lengths), float(np.linalg.norm(joints[0, 1] - joints[0, 0]))


def triangles(joints: np.ndarray) -> np.ndarray:
    """The ring of voussoirs in triangles that do not cross x = 0, (n, 3, 2)."""
    found = []
    for (a, b), (d, c) in zip(joints[:-1], joints[1:], strict=True):
        quads = [[a, b, c, d]]
        if a[0] * d[0] < 0.0:
            low, high = np.array([0.0, a[1]]), np.array([0.0, b[1]])
            quads = [[a, b, high, low], [low, high, c, d]]
        found += [triangle for q in quads for triangle in ([q[0], q[1], q[2]], [q[0], q[2], q[3]])]
    return np.array(found)


@pytest.mark.parametrize("keys", GROINS.values(), ids=GROINS)
def test_a_groin_vault_is_two_barrels_less_what_lies_beyond_the_groins(keys):
    """A web reaches from |x| to the edge a, both times the ratio s of the spans: s ∫ (a − |x|) dA over the profile."""
    model = model_of(vault(**keys))
    joints, s = arch_joints(keys), keys.get("length", keys["span"]) / keys["span"]
    half = joints[-1, 1, 0]
    parts = triangles(joints)
    arms = parts[:, 1:] - parts[:, :1]
    areas = 0.5 * np.abs(arms[:, 0, 0] * arms[:, 1, 1] - arms[:, 0, 1] * arms[:, 1, 0])
    reach = half - np.abs(parts[:, :, 0].mean(axis=1))
    assert free_volume(model) == pytest.approx(4.0 * s * (areas * reach).sum(), rel=1e-12)
    skin = 2.0 * (1.0 + s) * areas.sum()  # the four edges
    for line in (joints[:, 0], joints[:, 1]):
        steps = np.diff(line, axis=0)
        ends = np.abs(line[:-1, 0]), np.abs(line[1:, 0])
        mean = np.where(line[:-1, 0] * line[1:, 0] < 0.0, ends[0] / 2.0, (ends[0] + ends[1]) / 2.0)
        for across, along in ((1.0, s), (s, 1.0)):
            skin += 2.0 * (np.hypot(across * steps[:, 0], steps[:, 1]) * along * (half - mean)).sum()
    width, height = np.abs(joints[0, 1] - joints[0, 0])
    for across, along in ((1.0, s), (s, 1.0)):  # the triangles on which it stands
        skin += 4.0 * np.hypot(across * width, height) * along * width / 2.0
    assert open_area(model) == pytest.approx(skin, rel=1e-9)


@pytest.mark.parametrize("keys", CLOISTERS.values(), ids=CLOISTERS)
def test_a_cloister_vault_is_what_a_groin_vault_leaves_of_its_barrels(keys):
    """A web is as long in every height as its profile is wide there, times the ratio s of the spans: s ∫ 2|x| dA."""
    model = model_of(vault(**keys))
    joints, s = arch_joints(keys), keys.get("length", keys["span"]) / keys["span"]
    parts = triangles(joints)
    arms = parts[:, 1:] - parts[:, :1]
    areas = 0.5 * np.abs(arms[:, 0, 0] * arms[:, 1, 1] - arms[:, 0, 1] * arms[:, 1, 0])
    assert free_volume(model) == pytest.approx(4.0 * s * (areas * np.abs(parts[:, :, 0].mean(axis=1))).sum(), rel=1e-12)
    skin = 0.0
    for line in (joints[:, 0], joints[:, 1], joints[0], joints[-1]):  # both faces, and the beds on which it stands
        steps, ends = np.diff(line, axis=0), (np.abs(line[:-1, 0]), np.abs(line[1:, 0]))
        mean = np.where(line[:-1, 0] * line[1:, 0] < 0.0, ends[0] / 2.0, (ends[0] + ends[1]) / 2.0)
        for across, along in ((1.0, s), (s, 1.0)):
            skin += (np.hypot(across * steps[:, 0], steps[:, 1]) * along * 2.0 * mean).sum()
    assert open_area(model) == pytest.approx(skin, rel=1e-9)


def test_walls_below_a_cloister_vault_go_around_it():
    """A ring of that width and height."""
    width, height = 0.8, 2.0
    model = model_of(vault(**CLOISTER | {"piers": {"width": width, "height": height, "courses": 5}}))
    walls = np.array(["wall-" in name for name in model.block_ids])
    ring = (4.0 + 2.0 * width) ** 2 - 4.0**2
    assert model.shapes.volumes[walls].sum() == pytest.approx(ring * height, rel=1e-12)
    assert sum("sw-wall-" in name for name in model.block_ids) == 5


PIERS = {"piers": {"width": 0.6, "height": 2.0, "courses": 3}}


@pytest.mark.parametrize("keys", [GROIN, GROIN | {"voussoirs": 10} | PIERS, CLOISTER, CLOISTER | PIERS])
def test_a_cross_vault_is_its_own_mirror_image_to_the_last_bit(keys):
    blocks = shapes.build(Vault.model_validate({"kind": "vault", **keys}))
    drawn = solids(blocks, np.eye(3))
    swap = np.array([[0.0, 1.0, 0.0], [1.0, 0.0, 0.0], [0.0, 0.0, 1.0]])
    quarter = np.array([[0.0, -1.0, 0.0], [1.0, 0.0, 0.0], [0.0, 0.0, 1.0]])
    for change in (np.diag([-1.0, 1.0, 1.0]), np.diag([1.0, -1.0, 1.0]), swap, quarter, quarter @ quarter):
        assert solids(blocks, change) == drawn


def solids(blocks, change) -> list:
    """Corners and faces of every part of every block after a change of axes that is exact, in an order of their own."""
    found = []
    for block in blocks:
        parts = []
        for part in block.parts:
            corners = [tuple(0.0 + x for x in row) for row in (part.vertices @ change.T).tolist()]  # no −0
            faces = sorted(sorted(corners[i] for i in loop) for loop in part.faces)
            parts.append((sorted(corners), faces))
        found.append((block.fixed, block.course, sorted(parts)))
    return sorted(found)


def test_what_blocks_are_called():
    assert names(**DOME | {"courses": 2, "per_course": 3, "drum": {"width": 0.8, "height": 1.0}}) == [
        *(f"base-{n}" for n in (1, 2, 3)),
        *(f"drum-1-{n}" for n in (1, 2, 3)),
        *(f"{k}-{n}" for k in (1, 2) for n in (1, 2, 3)),
        "cap",
    ]
    barrel = names(**BARREL | {"voussoirs": 2, "rows": 2, "piers": {"width": 0.6, "height": 1.0}})
    assert barrel == ["base-left", "base-right", "left-1-1", "left-1-2", "left-1-3", "right-1-1", "right-1-2", "1-1",
                      "1-2", "2-1", "2-2", "2-3"]  # fmt: skip
    groin = names(**GROIN | {"voussoirs": 3, "rows": 4})
    assert groin[:4] == ["base-sw", "base-se", "base-ne", "base-nw"]
    assert {"boss", "sw-1", "ne-1"} <= set(groin)
    assert "south-2-1" in groin
    cloister = names(**CLOISTER | {"voussoirs": 3, "rows": 4})
    assert cloister == [*(f"base-{side}" for side in ("south", "north", "west", "east")),
                        *(f"{side}-1-{n}" for side in ("south", "north", "west", "east") for n in (1,)),
                        *(f"{corner}-1" for corner in ("sw", "se", "ne", "nw")), "boss"]  # fmt: skip


def test_no_stone_is_a_sliver():
    """None shorter than a quarter of a stone, none of the groins with a shorter arm."""
    for block in shapes.build(Vault.model_validate(vault(**BARREL | {"offset": 0.2}))):
        assert block.across is not None
        assert block.across[1] - block.across[0] > 0.25 * 1.5
    for block in shapes.build(Vault.model_validate(vault(**GROIN | {"rows": 8, "groins": "mitred"}))):
        corners = block.parts[0].vertices
        along = 1 if block.id.startswith(("north", "south")) else 0
        assert np.ptp(corners[:, along]) > 0.25 * 2.0 * 2.4 / 8 * (1 - 1e-9)


REFUSED = {
    "radius: not used by a barrel, which has span, length, voussoirs, rise, included_angle_deg, rows, offset, piers": (
        BARREL | {"radius": 1.0}
    ),
    "courses: missing: a dome needs radius, courses, per_course": {"shape": "dome", "radius": 1.0, "thickness": 0.1},
    "included_angle_deg: rise and included_angle_deg say the same; give one of them": (
        BARREL | {"rise": 1.0, "included_angle_deg": 90.0}
    ),
    "oculus_radius: oculus_deg and oculus_radius say the same; give one of them": (
        DOME | {"oculus_deg": 9.0, "oculus_radius": 0.5}
    ),
    "offset: 1.5 is not allowed; must be less than a stone is long, 1.5": BARREL | {"offset": 1.5},
    "voussoirs: 9 is not allowed; must be even: a pointed arch has a joint at the top": BARREL | {"rise": 3.0},
    "piers width: 0.3 is not allowed; must be at least 0.4, as the springing joint": (
        BARREL | {"piers": {"width": 0.3, "height": 1.0}}
    ),
    "piers width: 0.3 is not allowed; must be at least 0.4, as the springing of the webs": (
        GROIN | {"piers": {"width": 0.3, "height": 1.0}}
    ),
    "per_course: 2 values; must be one for each of the 6 courses": DOME | {"per_course": [12, 12]},
    "per_course 2: 5 is not allowed; 2 times the stones of a course must divide the 24 facets around": (
        DOME | {"per_course": [12, 12, 5, 6, 6, 6]}
    ),
    "radius: 0.2 is not allowed; must be more than 0.2, half the thickness": DOME | {"radius": 0.2},
    "oculus_deg: 40 is not allowed; the dome springs at 30 degrees": DOME | {"oculus_deg": 40.0, "springing_deg": 30.0},
    "oculus_radius: 6 is not allowed; the dome springs at 90 degrees": DOME | {"oculus_radius": 6.0},
    "drum width: 0.3 is not allowed; must be at least 0.4, as the springing joint": (
        DOME | {"drum": {"width": 0.3, "height": 1.0}}
    ),
}


@pytest.mark.parametrize(("message", "keys"), REFUSED.items(), ids=REFUSED)
def test_what_cannot_be_built_is_said_with_its_key(message, keys):
    with pytest.raises((ValidationError, KeyProblem)) as caught:
        shapes.build(Vault.model_validate({"kind": "vault", **keys}))
    problem = caught.value
    if isinstance(problem, ValidationError):
        problem = problem.errors()[0]["ctx"]["error"]
    assert f"{' '.join(map(str, problem.keys))}: {problem}" == message
