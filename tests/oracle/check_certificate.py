"""Check the certificates of a pushover from results.h5 alone: python check_certificate.py results.h5 ...

Independent of dem_cli: weights, loads and contacts come from corners and densities. Blocks in the plane are prisms;
convex parts touch where a face of one has the other on its outer side. What is proved: docs/certificates.md.
"""

from __future__ import annotations

import re
import sys
import tomllib

import h5py
import numpy as np

NEAR = 1e-4  # of the smallest edge: gap of faces that touch as drawn
OFF = 1e-3  # of it: how far a contact point may lie off faces of both blocks, which overlap on springs
RESIDUAL = 1e-4  # of the loads on a block: largest unbalanced force (moment: over its radius)
CONE = 1e-6  # of the largest normal force: how far a contact force may lie outside its cone
EXACT, SAME = 1e-9, 1e-7  # of what is copied: multipliers, friction; of what is computed another way: masses, loads
HOLDS = 2e-4  # of the bound: what inadmissible rates of its mechanism may add, and where the bracket holds it
SLIDES, CARRIES, LEAST_GAP = 1e-3, 1e-6, 1e-9  # of the bound: work of friction; of the largest force; gap of the bounds
PROVED, REFUSED, NONE = "proved", "refused", "none"


class Part:
    """Convex part of a block: corners (n, 3), faces as corners counter-clockwise seen from outside, their planes."""

    def __init__(self, block: int, corners: np.ndarray, faces: list[np.ndarray]) -> None:
        self.block, self.corners, self.faces = block, corners, faces
        areas = np.array([sum(np.cross(c[1:-1] - c[0], c[2:] - c[0])) for c in (corners[face] for face in faces)])
        self.normals = areas / np.linalg.norm(areas, axis=1)[:, None]
        self.on = corners[[face[0] for face in faces]]

    def outside(self, points: np.ndarray) -> np.ndarray:
        """How far points lie outside of each face [m], (n_points, n_faces)."""
        return points @ self.normals.T - (self.normals * self.on).sum(axis=1)


class Structure:
    """Blocks of a file, with masses and loads computed anew; `faults` says what differs, `notes` what is not known."""

    def __init__(self, dem: h5py.Group) -> None:
        m, self.case = dem["model"], tomllib.loads(dem["case"][()].decode())
        self.d, self.fixed = int(m.attrs["dimension"]), m["fixed"][:].astype(bool)
        self.spread, self.faults, self.notes = np.eye(6)[[0, 1, 5] if self.d == 2 else range(6)], [], []
        self.ids, names = ([name.decode() for name in m[key][:]] for key in ("block_ids", "material_names"))
        self.materials = [names[k] for k in m["block_material"][:]]
        self.centroids, held = wide(m["centroids"][:]), m["restrained"][:] if "restrained" in m else False
        self.free = (~(self.fixed[:, None] | held)) * np.ones(len(self.spread)) @ self.spread > 0.0
        self.parts = self._parts(m)
        edges = (p.corners[face] - p.corners[np.roll(face, 1)] for p in self.parts for face in p.faces)
        self.near = NEAR * min(np.linalg.norm(edge, axis=1).min() for edge in edges)
        self._weigh(m)
        self.dead, self.live = (m[key][:] @ self.spread for key in ("dead_loads", "live_loads"))
        self._compare_loads()
        self.drawn = np.pad(self.centroids[:, : self.d], ((0, 0), (0, 1 if self.d == 2 else 4)))
        self.drawn[:, 3:4] = 1.0  # of quaternions

    def _parts(self, m: h5py.Group) -> list[Part]:
        starts, vertices, found = m["part_starts"][:], wide(m["vertices"][:]), []
        self.height = 2.0 * float(np.abs(vertices).max())  # of the prisms that stand for blocks in the plane
        up = np.array([0.0, 0.0, 0.5 * self.height])
        for k, (a, b) in enumerate(zip(starts[:-1], starts[1:], strict=True)):
            if self.d == 2:
                low, corners = np.arange(b - a), np.vstack([vertices[a:b] - up, vertices[a:b] + up])
                nxt = np.roll(low, -1)
                faces = [low[::-1], low + (b - a), *np.stack([low, nxt, nxt + (b - a), low + (b - a)], axis=1)]
            else:
                corners, cut = vertices[a:b], m["face_starts"][m["part_faces"][k] : m["part_faces"][k + 1] + 1]
                faces = [m["face_corners"][i:j] - a for i, j in zip(cut[:-1], cut[1:], strict=True)]
            found.append(Part(int(m["part_blocks"][k]), corners, faces))
        return found

    def _weigh(self, m: h5py.Group) -> None:
        volumes, self.radii, moments = (np.zeros((len(self.fixed), *more)) for more in ((), (), (3,)))
        for p in self.parts:
            self.radii[p.block] = max(self.radii[p.block], np.linalg.norm(p.corners[:, : self.d], axis=1).max())
            fans = [p.corners[face] - p.corners[0] for face in p.faces]
            fours = np.array([(c[0], c[k], c[k + 1]) for c in fans for k in range(1, len(c) - 1)])
            tetrahedra = np.linalg.det(fours) / 6.0  # from the first corner
            if tetrahedra.sum() <= 0.0 or p.outside(p.corners).max() > self.near:
                self.faults.append(f"a part of {self.ids[p.block]} is not convex")
            volumes[p.block] += tetrahedra.sum()
            moments[p.block] += tetrahedra @ (p.corners[0] + fours.sum(axis=1) / 4.0)
        depth = m["thickness"][:] / self.height if self.d == 2 else 1.0
        self.masses = np.array([self.case["materials"][name]["density"] for name in self.materials]) * volumes * depth
        wrong = np.abs(m["masses"][:] - self.masses) > SAME * self.masses
        if (wrong | (np.linalg.norm(moments, axis=1) > SAME * volumes * self.radii)).any():
            self.faults.append("masses are not density times volume, or corners not about centroids")

    def _compare_loads(self) -> None:
        """Compare loads with weights, their pattern and forces on named blocks; others are taken as they are."""
        analysis, up, others = self.case["analysis"], self.d - 1, False
        dead, live, applied = (np.zeros_like(self.dead) for _ in range(3))
        dead[:, up] = -self.masses * self.case["gravity"]
        if analysis["pattern"] != "live":
            way = wide(np.array([analysis["direction"]], float))[0]
            way[up] *= analysis["pattern"] != "tilt"
            live[:, :3] = -dead[:, up : up + 1] * way / np.linalg.norm(way)
        for load in self.case.get("load", []):
            if load.get("block") in self.ids and not ({"line", "spread"} & load.keys() or load.get("inertia")):
                i, force = self.ids.index(load["block"]), wide(np.array([load["force"]], float))[0]
                arm = wide(np.array([load["at"]], float))[0] - self.centroids[i] if "at" in load else np.zeros(3)
                to = {"dead": dead, "live": live if analysis["pattern"] == "live" else applied}[load["kind"]]
                to[i] += np.concatenate([force, np.cross(arm, force)])
                others |= load["kind"] == "dead" and analysis["pattern"] == "tilt"
            else:
                others = True
        others |= any(self.case.get(key) for key in ("pressure", "fill"))
        others |= any({"floors", "fill"} & table.keys() for table in self.case.get("structure", []))
        for name, given, due in (("dead", self.dead, dead), ("live", self.live, live)):
            if (np.abs(given - due)[self.free] > SAME * max(np.abs(given).max(), np.abs(due).max())).any():
                (self.notes if others else self.faults).append(
                    f"{name} loads are not of weights and named blocks alone"
                )

    def friction(self, a: int, b: int, told: float) -> float:
        """The coefficient between two blocks: as told where the case allows that or has it drawn at random."""
        joints, pair = self.case["joints"], sorted((self.materials[a], self.materials[b]))
        named = [one["joint"] for one in self.case.get("interface", []) if sorted(one["between"]) == pair]
        table = joints[(*named, next(iter(joints)))[0]]
        tables = [table, *(joints[table["head"]] for _ in (1,) if table.get("head", "none") != "none")]
        angles = [np.tan(np.radians(t["friction_angle_deg"])) if "friction" not in t else t["friction"] for t in tables]
        allowed = any(t.get("variation") for t in tables) or min(abs(told - due) for due in angles) <= EXACT * told
        return told if allowed else float(max(angles))

    def placed(self, places: np.ndarray) -> list[Part]:
        """Parts where the blocks are; places: centroid, then angle or quaternion."""
        at, turns = wide(places[:, : self.d]), [rotation(row) for row in places[:, self.d :]]
        return [Part(p.block, p.corners @ turns[p.block].T + at[p.block], p.faces) for p in self.parts]


def wide(values: np.ndarray) -> np.ndarray:
    """Points or vectors in space, (n, 3)."""
    return np.pad(values, ((0, 0), (0, 3 - values.shape[1])))


def rotation(turned: np.ndarray) -> np.ndarray:
    """Matrix of an angle about z, or of a unit quaternion."""
    half = 0.5 * turned[0]
    w, *axis = (np.cos(half), 0.0, 0.0, np.sin(half)) if len(turned) == 1 else turned / np.linalg.norm(turned)
    across = np.cross(np.eye(3), axis)
    return np.eye(3) + 2.0 * w * across + 2.0 * across @ across


def forces(
    s: Structure, file: h5py.Group, name: str, places: np.ndarray, dead: float, live: float
) -> tuple[list[str], str, np.ndarray]:
    """Check contact forces: what is wrong with them, figures in words, and normal force, shear force, friction."""
    d, blocks, table = s.d, file[f"{name}_blocks"][:], file[f"{name}_contacts"][:]
    points, normals, centres, parts = (
        wide(table[:, :d]),
        wide(table[:, d : 2 * d]),
        wide(places[:, :d]),
        s.placed(places),
    )
    first = table[:, 6:9] if d == 3 else np.cross([0.0, 0.0, 1.0], normals)
    skew = [*(np.linalg.norm(v, axis=1) - 1.0 for v in (first, normals)), (first * normals).sum(axis=1)]
    normal, *tangential, friction = table[:, -1 - d :].T
    total, shear = dead * s.dead + live * s.live, np.linalg.norm(tangential, axis=0)
    scale = sum(abs(f) * np.linalg.norm(loads[:, :3], axis=1) for f, loads in ((dead, s.dead), (live, s.live)))
    axes = (normals, first, np.cross(normals, first))[:d]
    force = sum(along[:, None] * axis for along, axis in zip((normal, *tangential), axes, strict=True))
    for block, sign in zip(blocks.T, (-1.0, 1.0), strict=True):
        np.add.at(total, block, sign * np.hstack([force, np.cross(points - centres[block], force)]))
    total[:, 3:] /= s.radii[:, None]
    limits = {
        "residual": (float((np.where(s.free, np.abs(total), 0.0) / scale[:, None]).max()), RESIDUAL),
        "cone excess": (np.maximum(shear - friction * normal, -normal).max() / max(normal.max(), 1e-300), CONE),
        "skew normals": (float(np.abs(skew).max()), EXACT),
    }
    of, off, faults = {b: [p for p in parts if p.block == b] for b in set(blocks.ravel().tolist())}, 0.0, []
    for (a, b), at, n, mu in zip(blocks, points, normals, friction, strict=True):
        apart = (
            ((p.corners - at) @ n, (at - q.corners) @ n, p.outside(at), q.outside(at)) for p in of[a] for q in of[b]
        )
        off = max(off, min(max(part.max() for part in four) for four in apart))
        if s.friction(a, b, mu) != mu:
            faults = [f"friction between {s.ids[a]} and {s.ids[b]} is not that of the case"]
    for what, (value, limit) in (limits | {"metres off faces": (off, s.near * OFF / NEAR)}).items():
        faults += [] if value <= limit else [f"{what} {value:.2g}, at most {limit:.2g} is accepted"]
    words = ", ".join(f"{what} {limits[what][0]:.1e}" for what in ("residual", "cone excess"))
    return faults, f"{words}, {off:.1e} m off faces", np.array([normal, shear, friction])


def clipped(points: np.ndarray, outside: np.ndarray, near: float) -> np.ndarray:
    """Cut off what of a polygon, a line or a point lies outside of planes: normals and offsets, (n, 4)."""
    for plane in outside:
        out, kept = points @ plane[:3] - plane[3], []
        for k in range(len(points)):
            if (out[k - 1] > near) != (out[k] > near):
                kept.append(points[k - 1] + (points[k] - points[k - 1]) * out[k - 1] / (out[k - 1] - out[k]))
            kept += [points[k]] if out[k] <= near else []
        points = np.array(kept).reshape(-1, 3)
    return points


def contact(p: Part, q: Part, near: float) -> tuple[np.ndarray, np.ndarray] | None:
    """Normal from p to q and corners of the contact of two parts; None: there is none, or lines of several normals."""
    lines = []
    for one, other, sign in ((p, q, 1.0), (q, p, -1.0)):
        above = one.outside(other.corners)
        for k in np.flatnonzero(np.abs(above.min(axis=0)) <= near):
            within, ring = np.abs(above[:, k]) <= near, one.corners[one.faces[k]]
            whole = [face for face in other.faces if within[face].all()]
            sides = np.cross(np.roll(ring, -1, axis=0) - ring, one.normals[k])
            sides /= np.linalg.norm(sides, axis=1)[:, None]
            planes = np.hstack([sides, (sides * ring).sum(axis=1)[:, None]])
            found = clipped(other.corners[whole[0] if whole else within], planes, near)
            lines += [(sign * one.normals[k], found)] if len(found) else []
            if len(found) and np.linalg.svd(found - found.mean(axis=0), compute_uv=False)[1:2].sum() > 10 * near:
                return lines[-1]
    return lines[0] if lines and all(n @ lines[0][0] > 1 - EXACT for n, _ in lines) else None


def impossible(s: Structure, file: h5py.Group, claim: float) -> tuple[list[str], str]:
    """Check that no forces inside their cones balance a load above the bound: sliding faces part by μ slip."""
    rates, pairs = file["mechanism_rates"][:] @ s.spread, np.sort(file["mechanism_blocks"][:], axis=1).tolist()
    known = dict(zip(map(tuple, pairs), file["mechanism_contacts"][:, -1], strict=True))
    parts, off, count = s.placed(s.drawn), 0.0, 0
    low, high = (np.array([end(p.corners, axis=0) for p in parts]) for end in (np.min, np.max))
    for i, p in enumerate(parts):
        close = ((low[i + 1 :] <= high[i] + s.near) & (high[i + 1 :] >= low[i] - s.near)).all(axis=1)
        for q in (parts[j] for j in i + 1 + np.flatnonzero(close)):
            pair = p.block, q.block
            if pair[0] == pair[1] or s.fixed[[*pair]].all() or (found := contact(p, q, s.near)) is None:
                continue
            a, b = (rates[k, :3] + np.cross(rates[k, 3:], found[1] - s.centroids[k]) for k in pair)
            slip = np.linalg.norm(np.cross(found[0], b - a), axis=1)
            mu = s.friction(*pair, known.get(tuple(sorted(pair)), 0.0))
            off, count = max(off, float((mu * slip - (b - a) @ found[0]).max())), count + 1
    power, given = float((s.live * rates)[s.free].sum()), -float((s.dead * rates)[s.free].sum())
    if power <= 0.0 or np.abs(rates[~s.free]).max(initial=0.0) > 0.0 or claim != file["mechanism_bounds"][1]:
        return ["live loads gain no power, or what is held moves, or the bound is another one"], ""
    total = np.linalg.norm((s.dead + claim * s.live)[~s.fixed, :3], axis=1).sum()
    bound, more = given / power, float(off * total / power)
    words = f"{bound:.8g} by its power, inadmissible rates add {more:.1e}, {count} contacts found"
    right = max(abs(bound - claim), more) <= HOLDS * abs(claim)
    return [] if right else [f"the mechanism certifies {words}"], words


def fails(s: Structure, file: h5py.Group, claim: float) -> tuple[list[str], str]:
    """Check that the load is above the bound, or released more work than friction and joints took as blocks moved."""
    if "failing_places" not in file:
        faults, words = impossible(s, file, upper := float(file["mechanism_bounds"][1]))
        return faults + ([] if claim > upper else [f"the bound is {upper}"]), f"above {words}"
    (dead, live), places, energies = (file[f"failing_{key}"][:] for key in ("factors", "places", "energies"))
    turned = np.array([rotation(b) @ rotation(a).T for a, b in zip(*places[:, :, s.d :], strict=True)])
    spins = 0.5 * (turned - turned.swapaxes(1, 2))[:, [2, 0, 1], [1, 2, 0]]
    moved = np.hstack([wide(places[1, :, : s.d] - places[0, :, : s.d]), spins])
    work = float(((dead * s.dead + live * s.live) * moved)[s.free].sum())
    taken, far = float(np.diff(energies, axis=0)[0, 1:3].sum()), np.linalg.norm(moved[:, :3], axis=1).max()
    words = f"blocks move {far:.2e} m, loads do {work:.4g} J, friction and joints took {taken:.4g} J"
    return ([] if work > max(taken, 0.0) else [f"nothing is released: {words}"]), words


def unique(s: Structure, file: h5py.Group, low: float, high: float) -> tuple[list[str], str]:
    """Check that friction takes no part in any mechanism whose work is the bound."""
    lower, upper = file["mechanism_bounds"][:]
    faults, words, (normal, shear, friction) = forces(s, file, "mechanism", s.drawn, 1.0, lower)
    carries = (friction > 0.0) & (normal > CARRIES * normal.max())
    least = float((1.0 - shear[carries] / (friction * normal)[carries]).min(initial=1.0))
    share = max((upper - lower) / abs(upper), LEAST_GAP) / max(least, 1e-300)
    words = f"friction takes at most {share:.1e} of the work of any mechanism; {words}"
    held = low - HOLDS * abs(upper) <= upper <= high + HOLDS * abs(upper)
    return faults + ([] if held and share <= SLIDES else [f"bound {upper:.8g}: {words}"]), words


def check(path: str) -> dict[str, tuple[str, str]]:
    """Verdict on each claim of a file, PROVED, REFUSED or NONE, and why."""
    with h5py.File(path) as results:
        file, found, loads, s = results["dem/certificates"], {}, {}, None
        for claim, test, of in TESTS:
            said = str(file.attrs[claim])
            if said.startswith("none: "):
                found[claim] = NONE, said[6:]
                continue
            s = s or Structure(results["dem"])
            if number := re.search(r"load multiplier of (\S+)", said):
                loads[claim] = float(number[1])
            asked = (claim,) if number else ("stands", "fails")
            given = [loads.get(one, loads.get("impossible")) for one in asked]
            faults, words = test(s, file, *given)
            if of in file and abs(file[of][1] / file[of][0] - given[0]) > EXACT * max(abs(given[0]), 1.0):
                faults.append(f"loads are those of {file[of][1] / file[of][0]:.8g}")
            faults += s.faults
            found[claim] = REFUSED if faults else PROVED, "; ".join(faults or [f"{said}: {words}", *s.notes])
    return found


TESTS = (
    ("stands", lambda s, f, _: forces(s, f, "standing", f["standing_places"][:], *f["standing_factors"][:])[:2],
     "standing_factors"),
    ("impossible", impossible, "-"), ("fails", fails, "failing_factors"), ("unique", unique, "-"),
)  # fmt: skip
if __name__ == "__main__":
    found = {(path, claim): what for path in sys.argv[1:] for claim, what in check(path).items()}
    print("\n".join(f"{path}: {claim} {verdict}: {words}" for (path, claim), (verdict, words) in found.items()))
    sys.exit(int(any(verdict == REFUSED for verdict, _ in found.values())))
