"""Check the certificates of a pushover from results.h5 alone: python check_certificate.py results.h5 ...

Independent of dem_cli: numpy, h5py and the standard library. Volumes, weights, loads and contacts come from corners and
the case's densities. Blocks in the plane are prisms, so that one geometry serves both: convex parts touch where a face
of one has the other on its outer side. What each certificate proves: docs/certificates.md.
"""

from __future__ import annotations

import sys
import tomllib
from typing import NamedTuple

import h5py
import numpy as np

NEAR = 1e-4  # of the smallest edge: what touches, and how far a contact point may lie off faces of both blocks
RESIDUAL = 1e-4  # of the loads on a block: largest unbalanced force (moment: over its radius)
CONE = 1e-6  # of the largest normal force: how far a contact force may lie outside its cone
EXACT = 1e-9  # of multipliers, coefficients and unit vectors, which are copies
SAME = 1e-7  # of masses, loads and centroids, which are computed another way
HOLDS = 2e-4  # of the bound: what inadmissible rates of its mechanism may add, and where the bracket holds it
SLIDES, CARRIES, LEAST_GAP = 1e-3, 1e-6, 1e-9  # of the bound: work of friction; of the largest force; gap of the bounds
PROVED, REFUSED, NONE = "proved", "refused", "none"


class Finding(NamedTuple):
    """What the checker says of a claim; verdict: PROVED, REFUSED or NONE."""

    claim: str
    verdict: str
    words: str


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

    def volume_and_moment(self) -> tuple[float, np.ndarray]:
        """Volume and its first moment, by tetrahedra from the first corner."""
        base, fans = self.corners[0], [self.corners[face] - self.corners[0] for face in self.faces]
        fours = np.array([(c[0], c[k], c[k + 1]) for c in fans for k in range(1, len(c) - 1)])
        volumes = np.linalg.det(fours) / 6.0
        return float(volumes.sum()), volumes @ (base + fours.sum(axis=1) / 4.0)


class Structure:
    """Blocks of a file, with masses and loads computed anew; `faults` says what differs, `notes` what is not known."""

    def __init__(self, dem: h5py.Group) -> None:
        m, self.case = dem["model"], tomllib.loads(dem["case"][()].decode())
        self.d, self.fixed = int(m.attrs["dimension"]), m["fixed"][:].astype(bool)
        self.dofs, self.faults, self.notes = [0, 1, 5] if self.d == 2 else list(range(6)), [], []
        self.ids, names = ([name.decode() for name in m[key][:]] for key in ("block_ids", "material_names"))
        self.materials = [names[k] for k in m["block_material"][:]]
        self.centroids, held = wide(m["centroids"][:]), m["restrained"][:] if "restrained" in m else False
        self.free = np.zeros((len(self.fixed), 6), bool)
        self.free[:, self.dofs] = ~(self.fixed[:, None] | held)
        self.parts = self._parts(m)
        self.near = NEAR * min(
            np.linalg.norm(p.corners[f] - np.roll(p.corners[f], 1, 0), axis=1).min()
            for p in self.parts for f in p.faces[: 1 if self.d == 2 else None]
        )  # fmt: skip
        self.radii = np.zeros(len(self.fixed))
        np.maximum.at(self.radii, m["part_blocks"][:],
                      [np.linalg.norm(p.corners[:, : self.d], axis=1).max() for p in self.parts])  # fmt: skip
        self._weigh(m)
        self.dead, self.live = (self.generalised(m[key][:]) for key in ("dead_loads", "live_loads"))
        self._compare_loads()
        unturned = [0.0] if self.d == 2 else [1.0, 0.0, 0.0, 0.0]
        self.drawn = np.hstack([self.centroids[:, : self.d], np.tile(unturned, (len(self.fixed), 1))])

    def generalised(self, values: np.ndarray) -> np.ndarray:
        """Translations and rotations in space, (n, 6)."""
        whole = np.zeros((len(values), 6))
        whole[:, self.dofs] = values
        return whole

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
        volumes, moments = np.zeros(len(self.fixed)), np.zeros((len(self.fixed), 3))
        for p in self.parts:
            volume, moment = p.volume_and_moment()
            if volume <= 0.0 or p.outside(p.corners).max() > self.near:
                self.faults.append(f"a part of block {self.ids[p.block]} is not convex")
            volumes[p.block] += volume
            moments[p.block] += moment
        if (np.linalg.norm(moments, axis=1) > SAME * volumes * self.radii).any():
            self.faults.append("corners are not about the centroid of their block")
        depth = m["thickness"][:] / self.height if self.d == 2 else 1.0
        self.masses = np.array([self.case["materials"][name]["density"] for name in self.materials]) * volumes * depth
        if (np.abs(m["masses"][:] - self.masses) > SAME * self.masses).any():
            self.faults.append("masses are not density times volume")

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
                said = self.notes if others else self.faults
                said.append(f"{name} loads are not weights and forces on named blocks alone")

    def frictions(self, a: int, b: int) -> list[float]:
        """Coefficients that the case allows between two blocks; none: they are drawn at random."""
        joints, pair = self.case["joints"], sorted((self.materials[a], self.materials[b]))
        named = [one["joint"] for one in self.case.get("interface", []) if sorted(one["between"]) == pair]
        table = joints[(*named, next(iter(joints)))[0]]
        tables = [table, *(joints[table["head"]] for _ in (1,) if table.get("head", "none") != "none")]
        angles = [np.tan(np.radians(t["friction_angle_deg"])) if "friction" not in t else t["friction"] for t in tables]
        return [] if any(t.get("variation") for t in tables) else angles

    def placed(self, places: np.ndarray) -> list[Part]:
        """Parts where the blocks are; places: centroid, then angle or quaternion."""
        at, turns = wide(places[:, : self.d]), [rotation(row) for row in places[:, self.d :]]
        return [Part(p.block, p.corners @ turns[p.block].T + at[p.block], p.faces) for p in self.parts]


def wide(values: np.ndarray) -> np.ndarray:
    """Points or vectors in space, (n, 3)."""
    return np.pad(values, ((0, 0), (0, 3 - values.shape[1])))


def rotation(turned: np.ndarray) -> np.ndarray:
    """Matrix of an angle about z, or of a unit quaternion."""
    w, *axis = (np.cos(turned[0] / 2), 0.0, 0.0, np.sin(turned[0] / 2)) if len(turned) == 1 else turned
    across = np.cross(np.eye(3), axis)
    return np.eye(3) + 2.0 * w * across + 2.0 * across @ across


class Forces:
    """Contact forces of a certificate: `standing` or `mechanism`, with parts and centroids where they act."""

    def __init__(self, s: Structure, file: h5py.Group, name: str, places: np.ndarray) -> None:
        self.s, d, self.blocks, table = s, s.d, file[f"{name}_blocks"][:], file[f"{name}_contacts"][:]
        self.points, self.normals = wide(table[:, :d]), wide(table[:, d : 2 * d])
        first = table[:, 6:9] if d == 3 else np.cross([0.0, 0.0, 1.0], self.normals)
        *shear, self.friction = table[:, -d:].T
        self.normal, self.shear = table[:, -1 - d], np.linalg.norm(shear, axis=0)
        self.forces = self.normal[:, None] * self.normals
        for along, tangent in zip(shear, (first, np.cross(self.normals, first)), strict=d == 3):
            self.forces = self.forces + along[:, None] * tangent
        lengths = [np.linalg.norm(v, axis=1) - 1.0 for v in (first, self.normals)]
        self.skew = float(np.abs([*lengths, (first * self.normals).sum(axis=1)]).max(initial=0.0))
        self.parts, self.centres = s.placed(places), wide(places[:, :d])

    def residual(self, dead: float, live: float) -> float:
        """Largest unbalanced force on a free block, over the loads on it (moments: times its radius)."""
        s, sizes = self.s, [np.linalg.norm(loads[:, :3], axis=1) for loads in (self.s.dead, self.s.live)]
        total, scale = dead * s.dead + live * s.live, dead * sizes[0] + abs(live) * sizes[1]
        for block, sign in zip(self.blocks.T, (-1.0, 1.0), strict=True):
            moments = np.cross(self.points - self.centres[block], self.forces)
            np.add.at(total, block, sign * np.hstack([self.forces, moments]))
        total[:, 3:] /= s.radii[:, None]
        return float((np.where(s.free, np.abs(total), 0.0) / scale[:, None]).max())

    def distance(self) -> float:
        """How far a point lies off faces of both blocks, or its plane does not part them [m]."""
        of = {b: [p for p in self.parts if p.block == b] for b in set(self.blocks.ravel().tolist())}
        worst = 0.0
        for (a, b), point, n in zip(self.blocks, self.points, self.normals, strict=True):
            worst = max(worst, min(
                max(p.outside(point).max(), q.outside(point).max(), ((p.corners - point) @ n).max(),
                    -((q.corners - point) @ n).min())
                for p in of[a] for q in of[b]
            ))  # fmt: skip
        return worst

    def check(self, dead: float, live: float) -> tuple[list[str], str]:
        """What is wrong with the forces, and their figures in words."""
        most = max(self.normal.max(initial=0.0), 1e-300)
        outside = np.maximum(self.shear - self.friction * self.normal, -self.normal).max(initial=0.0) / most
        residual, off, faults = self.residual(dead, live), self.distance(), []
        for (a, b), mu in zip(self.blocks, self.friction, strict=True):
            if not min((abs(mu - due) for due in self.s.frictions(a, b)), default=0.0) <= EXACT * max(mu, 1.0):
                faults = [f"friction between {self.s.ids[a]} and {self.s.ids[b]} is not that of the case"]
        for name, value, limit in (
            ("residual", residual, RESIDUAL), ("cone excess", outside, CONE), ("distance from faces", off, self.s.near),
            ("error of normals and tangents", self.skew, EXACT),
        ):  # fmt: skip
            faults += [] if value <= limit else [f"{name} {value:.2g}, at most {limit:.2g} is accepted"]
        return faults, f"residual {residual:.1e}, cone excess {outside:.1e}, {off:.1e} m off faces"


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
            if len(found) and np.linalg.svd(found - found.mean(axis=0), compute_uv=False)[1:2].sum() > 10 * near:
                return sign * one.normals[k], found
            lines += [(sign * one.normals[k], found)] if len(found) else []
    return lines[0] if lines and all(n @ lines[0][0] > 1 - EXACT for n, _ in lines) else None


def violation(s: Structure, rates: np.ndarray, known: dict[tuple[int, ...], float]) -> tuple[float, int]:
    """Largest rate at which contacts close, or slide without opening by μ times the slip, and how many were found."""
    parts, worst, n = s.placed(s.drawn), 0.0, 0
    low, high = (np.array([end(p.corners, axis=0) for p in parts]) for end in (np.min, np.max))
    for i, p in enumerate(parts):
        close = ((low[i + 1 :] <= high[i] + s.near) & (high[i + 1 :] >= low[i] - s.near)).all(axis=1)
        for q in (parts[j] for j in i + 1 + np.flatnonzero(close)):
            pair = p.block, q.block
            if pair[0] == pair[1] or s.fixed[[*pair]].all() or (found := contact(p, q, s.near)) is None:
                continue
            a, b = (rates[k, :3] + np.cross(rates[k, 3:], found[1] - s.centroids[k]) for k in pair)
            opening = (b - a) @ found[0]
            slip = np.linalg.norm(b - a - opening[:, None] * found[0], axis=1)
            mu = known.get(tuple(sorted(pair)), max(s.frictions(*pair), default=0.0))
            worst, n = max(worst, float((mu * slip - opening).max())), n + 1
    return worst, n


def multiplier(factors: np.ndarray, claim: float) -> list[str]:
    """What is wrong with the factors of dead and live loads."""
    load = factors[1] / factors[0]
    return [] if abs(load - claim) <= EXACT * max(abs(claim), 1.0) else [f"loads are those of {load:.8g}, not {claim}"]


def stands(s: Structure, file: h5py.Group, claim: float) -> tuple[list[str], str]:
    """Check the contact forces of the highest load held."""
    factors = file["standing_factors"][:]
    faults, words = Forces(s, file, "standing", file["standing_places"][:]).check(*factors)
    return faults + multiplier(factors, claim), words


def impossible(s: Structure, file: h5py.Group, claim: float) -> tuple[list[str], str]:
    """Check that no forces inside their cones balance a load above the bound."""
    rates, pairs = s.generalised(file["mechanism_rates"][:]), np.sort(file["mechanism_blocks"][:], axis=1).tolist()
    known = dict(zip(map(tuple, pairs), file["mechanism_contacts"][:, -1], strict=True))
    off, n = violation(s, rates, known)
    power, given = float((s.live * rates)[s.free].sum()), -float((s.dead * rates)[s.free].sum())
    if power <= 0.0 or np.abs(rates[~s.free]).max(initial=0.0) > 0.0:
        return ["live loads gain no power, or what is held moves"], ""
    bound, total = given / power, float(np.linalg.norm((s.dead + claim * s.live)[~s.fixed, :3], axis=1).sum())
    more = off * total / power
    wrong = abs(bound - claim) > HOLDS * abs(claim) or more > HOLDS * abs(claim)
    words = f"{bound:.8g} by its power, inadmissible rates add {more:.1e}, {n} contacts found"
    return [f"the mechanism certifies {words}"] if wrong else [], words


def fails(s: Structure, file: h5py.Group, claim: float) -> tuple[list[str], str]:
    """Check that the load is above the bound, or released more work than friction and joints took as blocks moved."""
    if "failing_places" not in file:
        faults, words = impossible(s, file, upper := float(file["mechanism_bounds"][1]))
        return faults + ([] if claim > upper else [f"the bound is {upper}"]), f"above {words}"
    factors, places, energies = (file[f"failing_{key}"][:] for key in ("factors", "places", "energies"))
    turns = [[rotation(row) for row in instant[:, s.d :]] for instant in places]
    turned = [b @ a.T - a @ b.T for a, b in zip(*turns, strict=True)]
    moved = np.hstack([wide(places[1, :, : s.d] - places[0, :, : s.d]),
                       [(0.5 * t[2, 1], 0.5 * t[0, 2], 0.5 * t[1, 0]) for t in turned]])  # fmt: skip
    work = float(((factors[0] * s.dead + factors[1] * s.live) * moved)[s.free].sum())
    taken, far = float(np.diff(energies, axis=0)[0, 1:3].sum()), np.linalg.norm(moved[:, :3], axis=1).max()
    words = f"blocks move {far:.2e} m, loads do {work:.4g} J, friction and joints took {taken:.4g} J"
    return multiplier(factors, claim) + ([] if work > max(taken, 0.0) else [f"nothing is released: {words}"]), words


def unique(s: Structure, file: h5py.Group, low: float, high: float) -> tuple[list[str], str]:
    """Check that friction takes no part in any mechanism whose work is the bound."""
    forces, (lower, upper) = Forces(s, file, "mechanism", s.drawn), file["mechanism_bounds"][:]
    faults, words = forces.check(1.0, lower)
    limit = forces.friction * forces.normal
    carries = (forces.friction > 0.0) & (forces.normal > CARRIES * forces.normal.max())
    least = float(((limit - forces.shear)[carries] / limit[carries]).min(initial=1.0))
    share = max((upper - lower) / abs(upper), LEAST_GAP) / max(least, 1e-300)
    words = f"friction takes at most {share:.1e} of the work of any mechanism; {words}"
    wrong = share > SLIDES or not low - HOLDS * abs(upper) <= upper <= high + HOLDS * abs(upper)
    return faults + ([f"not shown: {words}, bound {upper:.8g} in {low:.8g} to {high:.8g}"] if wrong else []), words


def check(path: str) -> list[Finding]:
    """Check all certificates of a file."""
    with h5py.File(path) as results:
        if "certificates" not in results["dem"]:
            return [Finding("all", NONE, "there are no certificates")]
        file, found, loads, s = results["dem/certificates"], [], {}, None
        for claim, test in (("stands", stands), ("impossible", impossible), ("fails", fails), ("unique", unique)):
            said = str(file.attrs[claim])
            if said.startswith("none: "):
                found.append(Finding(claim, NONE, said[6:]))
                continue
            s = s or Structure(results["dem"])
            if claim != "unique":
                loads[claim] = float(next(word for word in said.split() if word.strip("-")[:1].isdigit()))
            given = (loads["stands"], loads["fails"]) if claim == "unique" else (loads[claim],)
            faults, words = test(s, file, *given)
            faults = s.faults + faults
            words = "; ".join(faults or [f"{said}: {words}", *s.notes])
            found.append(Finding(claim, REFUSED if faults else PROVED, words))
    return found


if __name__ == "__main__":
    findings = [(name, one) for name in sys.argv[1:] for one in check(name)]
    print("\n".join(f"{name}: {one.claim} {one.verdict}: {one.words}" for name, one in findings))
    sys.exit(int(any(one.verdict == REFUSED for _, one in findings)))
