"""Check the certificates of a pushover from results.h5 alone: blocks, weights and contacts from corners and densities.

    python check_certificate.py results.h5 ...

Independent of dem_cli: numpy, h5py and the standard library. Blocks in the plane are prisms, so that one geometry
serves both: convex parts touch where the plane of a face of one has the other on its outer side. What is accepted is
stated below; docs/certificates.md says what each certificate proves.
"""

from __future__ import annotations

import sys
import tomllib
from typing import NamedTuple

import h5py
import numpy as np

NEAR = 1e-4  # of the smallest edge: how far a contact point may lie off faces of both blocks; what touches
RESIDUAL = 1e-4  # of the loads on a block: largest unbalanced force (moment: over its radius)
CONE = 1e-6  # of the largest normal force: how far a contact force may lie outside its cone
EXACT = 1e-9  # of masses, loads and multipliers, which are computed in the same way
HOLDS = 2e-4  # of the bound: what inadmissible rates of the mechanism may add to it, and where the bracket holds it
SLIDES, CARRIES, LEAST_GAP = 1e-3, 1e-6, 1e-6  # work of friction over the bound; points that carry; gap of the bounds
PROVED, REFUSED, NONE = "proved", "refused", "none"


class Finding(NamedTuple):
    """What the checker says of a claim."""

    claim: str
    verdict: str  # PROVED, REFUSED or NONE
    words: str


class Part(NamedTuple):
    """Convex part of a block in space: corners, and faces as corners counter-clockwise seen from outside."""

    block: int
    corners: np.ndarray  # (n, 3) [m]
    faces: list[np.ndarray]

    @property
    def planes(self) -> tuple[np.ndarray, np.ndarray]:
        """Outer unit normals of the faces, and a corner of each, (n_faces, 3)."""
        normals = [newell(self.corners[face]) for face in self.faces]
        return np.array([n / np.linalg.norm(n) for n in normals]), self.corners[[face[0] for face in self.faces]]


def newell(polygon: np.ndarray) -> np.ndarray:
    """Twice the area of a polygon, along its normal."""
    return np.cross(polygon - polygon[0], np.roll(polygon, -1, axis=0) - polygon[0]).sum(axis=0)


def volume_and_centroid(part: Part) -> tuple[float, np.ndarray]:
    """Of a polyhedron, by tetrahedra from its first corner."""
    base, volume, moment = part.corners[0], 0.0, np.zeros(3)
    for face in part.faces:
        a = part.corners[face[0]] - base
        for b, c in zip(part.corners[face[1:-1]] - base, part.corners[face[2:]] - base, strict=True):
            v = float(a @ np.cross(b, c)) / 6.0
            volume, moment = volume + v, moment + v * (a + b + c) / 4.0
    return volume, base + moment / volume


class Structure:
    """Blocks of a file: parts about centroids, masses, loads and friction, each computed anew and compared."""

    def __init__(self, dem: h5py.Group) -> None:
        m, self.case = dem["model"], tomllib.loads(dem["case"][()].decode())
        self.d = int(m.attrs["dimension"])
        self.dofs = np.array([0, 1, 5] if self.d == 2 else range(6))
        self.centroids, self.fixed = self.wide(m["centroids"][:]), m["fixed"][:].astype(bool)
        self.ids = [name.decode() for name in m["block_ids"][:]]
        self.materials = [m["material_names"][k].decode() for k in m["block_material"][:]]
        self.free = np.zeros((len(self.fixed), 6), bool)
        self.free[:, self.dofs] = ~self.fixed[:, None]
        if "restrained" in m:
            self.free[:, self.dofs] &= ~m["restrained"][:].astype(bool)
        self.parts = self._parts(m)
        edges = [np.linalg.norm(p.corners[f] - np.roll(p.corners[f], 1, 0), axis=1).min()
                 for p in self.parts for f in (p.faces if self.d == 3 else p.faces[:1])]  # fmt: skip
        self.near = NEAR * min(edges)
        self.radii = np.zeros(len(self.fixed))
        flat = slice(None, self.d)
        for p in self.parts:
            reach = np.linalg.norm(p.corners[:, flat], axis=1).max()
            self.radii[p.block] = max(self.radii[p.block], reach)
        self.faults, self.notes = self._masses(m), []
        self.dead, self.live = (self.generalised(m[name][:]) for name in ("dead_loads", "live_loads"))
        self._loads()

    def wide(self, values: np.ndarray) -> np.ndarray:
        """Points or vectors in space, (n, 3)."""
        return values if values.shape[1] == 3 else np.pad(values, ((0, 0), (0, 1)))

    def generalised(self, values: np.ndarray) -> np.ndarray:
        """Translations and rotations, (n, 6)."""
        whole = np.zeros((len(values), 6))
        whole[:, self.dofs] = values
        return whole

    def _parts(self, m: h5py.Group) -> list[Part]:
        vertices, starts, blocks = m["vertices"][:], m["part_starts"][:], m["part_blocks"][:]
        found = []
        self.height = 2.0 * float(np.abs(vertices).max())  # of the prisms that stand for blocks in the plane
        for k, (a, b) in enumerate(zip(starts, starts[1:], strict=False)):
            n = int(b - a)
            if self.d == 2:
                flat = np.pad(vertices[a:b], ((0, 0), (0, 1)))
                low, high = np.arange(n), np.arange(n, 2 * n)
                sides = [np.array([i, (i + 1) % n, n + (i + 1) % n, n + i]) for i in range(n)]
                up = np.array([0.0, 0.0, 0.5 * self.height])
                found.append(Part(int(blocks[k]), np.vstack([flat - up, flat + up]), [low[::-1], high, *sides]))
                continue
            faces, ends = range(*m["part_faces"][k : k + 2]), m["face_starts"][:]
            outlines = [m["face_corners"][ends[f] : ends[f + 1]] - a for f in faces]
            found.append(Part(int(blocks[k]), vertices[a:b], outlines))
        return found

    def _masses(self, m: h5py.Group) -> list[str]:
        volumes, moments, faults = np.zeros(len(self.fixed)), np.zeros((len(self.fixed), 3)), []
        for p in self.parts:
            volume, centre = volume_and_centroid(p)
            normals, corners = p.planes
            if ((p.corners @ normals.T) - (normals * corners).sum(axis=1)).max() > self.near or volume <= 0.0:
                faults.append(f"a part of block {self.ids[p.block]} is not convex")
            volumes[p.block] += volume
            moments[p.block] += volume * centre
        if (np.linalg.norm(moments / volumes[:, None], axis=1) > 1e-6 * self.radii).any():
            faults.append("corners are not about the centroid of their block")
        depth = m["thickness"][:] / self.height if self.d == 2 else 1.0
        density = np.array([self.case["materials"][name]["density"] for name in self.materials])
        self.masses = density * volumes * depth
        if (np.abs(m["masses"][:] - self.masses) > 1e-7 * self.masses).any():
            faults.append("masses are not density times volume")
        return faults

    def _loads(self) -> None:
        """Compare the loads of the file with weights, their pattern, and the forces on named blocks."""
        analysis, up = self.case["analysis"], self.d - 1
        weights, live = np.zeros_like(self.dead), np.zeros_like(self.live)
        weights[:, up] = -self.masses * self.case["gravity"]
        pattern, others = analysis.get("pattern"), False
        forces = {"dead": np.zeros_like(live), "live": np.zeros_like(live)}
        for load in self.case.get("load", []):
            if load.get("block") not in self.ids or {"line", "spread"} & load.keys() or load.get("inertia"):
                others = True
                continue
            i, force = self.ids.index(load["block"]), self.wide(np.array([load["force"]], float))[0]
            at = self.wide(np.array([load["at"]], float))[0] if "at" in load else self.centroids[i]
            forces[load["kind"]][i] += np.concatenate([force, np.cross(at - self.centroids[i], force)])
        dead = weights + forces["dead"]
        if pattern == "live":
            live = forces["live"]
        else:
            way = self.wide(np.array([analysis["direction"]], float))[0]
            if pattern == "tilt":
                way[up] = 0.0
                others |= bool(forces["dead"].any())
            live[:, :3] = -weights[:, up : up + 1] * way / np.linalg.norm(way)
        others |= any(self.case.get(key) for key in ("pressure", "fill"))
        others |= any({"floors", "fill"} & table.keys() for table in self.case.get("structure", []))
        for name, given, due in (("dead", self.dead, dead), ("live", self.live, live)):
            scale = max(np.abs(given).max(), np.abs(due).max())
            if (np.abs(given - due)[self.free] > 1e-7 * scale).any():
                if others:
                    self.notes.append(f"{name} loads beside weights as the file has them")
                else:
                    self.faults.append(f"{name} loads are not those of the case")

    def frictions(self, a: int, b: int) -> set[float] | None:
        """Coefficients that the case allows between two blocks; None: they are drawn at random."""
        joints, pair = self.case["joints"], {self.materials[a], self.materials[b]}
        named = next((i["joint"] for i in self.case.get("interface", []) if set(i["between"]) == pair), None)
        table = joints[named or next(iter(joints))]
        tables = [table, *([joints[table["head"]]] if table.get("head") not in (None, "none") else [])]
        return None if any(t.get("variation") for t in tables) else {float(t["friction"]) for t in tables}

    def placed(self, places: np.ndarray) -> list[Part]:
        """Parts where the blocks are; places: centroid, then angle or quaternion."""
        at, turn = self.wide(places[:, : self.d]), [rotation(row) for row in places[:, self.d :]]
        return [p._replace(corners=p.corners @ turn[p.block].T + at[p.block]) for p in self.parts]


def rotation(turned: np.ndarray) -> np.ndarray:
    """Matrix of an angle about z, or of a unit quaternion."""
    if len(turned) == 1:
        turned = np.array([np.cos(turned[0] / 2), 0.0, 0.0, np.sin(turned[0] / 2)])
    w, x, y, z = turned / np.linalg.norm(turned)
    return np.array([
        [1 - 2 * (y * y + z * z), 2 * (x * y - w * z), 2 * (x * z + w * y)],
        [2 * (x * y + w * z), 1 - 2 * (x * x + z * z), 2 * (y * z - w * x)],
        [2 * (x * z - w * y), 2 * (y * z + w * x), 1 - 2 * (x * x + y * y)],
    ])  # fmt: skip


class Forces:
    """Contact forces of a certificate: equilibrium, cones, and whether faces are where they act."""

    def __init__(self, s: Structure, blocks: np.ndarray, table: np.ndarray, parts: list[Part], centres: np.ndarray):
        d = s.d
        self.s, self.blocks, self.points, self.normals = s, blocks, s.wide(table[:, :d]), s.wide(table[:, d : 2 * d])
        first = s.wide(table[:, 6:9]) if d == 3 else np.cross([0.0, 0.0, 1.0], self.normals)
        self.normal, self.friction = table[:, -1 - d], table[:, -1]
        shear = table[:, -d:-1]
        self.shear = np.linalg.norm(shear, axis=1)
        tangents = [first, np.cross(self.normals, first)][: d - 1]
        self.forces = self.normal[:, None] * self.normals
        self.forces = self.forces + sum(along[:, None] * t for along, t in zip(shear.T, tangents, strict=True))
        axes = np.concatenate([np.linalg.norm(self.normals, axis=1) - 1, (first * self.normals).sum(axis=1)])
        self.square = float(np.abs(np.append(axes, np.linalg.norm(first, axis=1) - 1)).max(initial=0.0))
        self.centres, self.parts = centres, parts

    def residual(self, dead: float, live: float) -> float:
        """Largest unbalanced force on a free block, over the loads on it (moments: times its radius)."""
        s = self.s
        total = dead * s.dead + live * s.live
        scale = dead * np.linalg.norm(s.dead[:, :3], axis=1) + abs(live) * np.linalg.norm(s.live[:, :3], axis=1)
        for side, sign in ((0, -1.0), (1, 1.0)):
            block = self.blocks[:, side]
            wrench = np.hstack([self.forces, np.cross(self.points - self.centres[block], self.forces)])
            np.add.at(total, block, sign * wrench)
        total[:, 3:] /= s.radii[:, None]
        return float(np.abs(np.where(s.free, total, 0.0) / scale[:, None]).max())

    def outside(self) -> float:
        """How far a force lies outside its cone, over the largest normal force."""
        worst = np.maximum(self.shear - self.friction * self.normal, -self.normal).max(initial=0.0)
        return float(worst / max(self.normal.max(initial=0.0), 1e-300))

    def distance(self) -> float:
        """How far a point lies off faces of both blocks, or its plane does not part them [m]."""
        of: dict[int, list[Part]] = {}
        for p in self.parts:
            of.setdefault(p.block, []).append(p)
        planes = {id(p): p.planes for p in self.parts}
        worst = 0.0
        for (a, b), point, normal in zip(self.blocks, self.points, self.normals, strict=True):
            found = [
                max([*(((point - c) * n).sum(axis=1).max() for n, c in (planes[id(p)], planes[id(q)])),
                     ((p.corners - point) @ normal).max(), -((q.corners - point) @ normal).min()])
                for p in of[a] for q in of[b]
            ]  # fmt: skip
            worst = max(worst, min(found))
        return worst

    def faults(self, dead: float, live: float) -> tuple[list[str], str]:
        """What is wrong with the forces, and their figures in words."""
        residual, outside, off = self.residual(dead, live), self.outside(), self.distance()
        faults = [f"friction between blocks {a} and {b} is not that of the case"
                  for (a, b), mu in zip(self.blocks, self.friction, strict=True)
                  if (of := self.s.frictions(a, b)) is not None and min(abs(mu - f) for f in of) > EXACT][:1]  # fmt: skip
        for name, value, most in (
            ("residual", residual, RESIDUAL), ("cone excess", outside, CONE), ("distance from faces", off, self.s.near),
            ("normals and tangents", self.square, EXACT),
        ):  # fmt: skip
            if not value <= most:
                faults.append(f"{name} {value:.2g}, at most {most:.2g} is accepted")
        return faults, f"residual {residual:.1e}, cone excess {outside:.1e}, {off:.1e} m off faces"


def clipped(points: np.ndarray, normals: np.ndarray, corners: np.ndarray, near: float) -> np.ndarray:
    """Cut a polygon, a line or a point off where it lies outside of planes, (n, 3)."""
    for n, c in zip(normals, corners, strict=True):
        out, kept = (points - c) @ n, []
        for k, point in enumerate(points):
            before, last = out[k - 1], points[k - 1]
            if (before > near) != (out[k] > near):
                kept.append(last + (point - last) * before / (before - out[k]))
            if out[k] <= near:
                kept.append(point)
        points = np.array(kept).reshape(-1, 3)
    return points


def contact(p: Part, q: Part, near: float) -> tuple[np.ndarray, np.ndarray] | None:
    """Normal from p to q and corners of the contact of two parts as drawn; None: there is none, or several normals."""
    lines = []
    for one, other, sign in ((p, q, 1.0), (q, p, -1.0)):
        normals, corners = one.planes
        for face, normal, corner in zip(one.faces, normals, corners, strict=True):
            above = (other.corners - corner) @ normal
            if not -near <= above.min() <= near:
                continue
            within = [f for f in other.faces if (np.abs(above[f]) <= near).all()]
            outline = other.corners[within[0]] if within else other.corners[np.abs(above) <= near]
            ring = one.corners[face]
            sides = np.cross(np.roll(ring, -1, axis=0) - ring, normal)
            found = clipped(outline, sides / np.linalg.norm(sides, axis=1)[:, None], ring, near)
            if len(found) and np.linalg.svd(found - found.mean(axis=0), compute_uv=False)[1:2].sum() > 10 * near:
                return sign * normal, found
            if len(found):
                lines.append((sign * normal, found))
    same = lines and all(n @ lines[0][0] > 1 - EXACT for n, _ in lines)
    return lines[0] if same else None


def violation(s: Structure, rates: np.ndarray, known: dict[tuple[int, int], float]) -> tuple[float, int]:
    """Largest rate by which a mechanism closes or slides without opening by friction times slip, and the contacts."""
    parts = s.placed(np.pad(s.centroids[:, : s.d], ((0, 0), (0, 1 if s.d == 2 else 4)), constant_values=0.0)
                     if s.d == 2 else np.hstack([s.centroids, np.tile([1.0, 0, 0, 0], (len(s.fixed), 1))]))  # fmt: skip
    low, high = (np.array([of(p.corners, axis=0) for p in parts]) for of in (np.min, np.max))
    blocks, worst, n = np.array([p.block for p in parts]), 0.0, 0
    for i, p in enumerate(parts):
        close = ((low[i + 1 :] <= high[i] + s.near) & (high[i + 1 :] >= low[i] - s.near)).all(axis=1)
        for j in i + 1 + np.flatnonzero(close & (blocks[i + 1 :] != p.block)):
            a, b = p.block, int(blocks[j])
            if (s.fixed[a] and s.fixed[b]) or (found := contact(p, parts[j], s.near)) is None:
                continue
            normal, points = found
            v = [rates[k, :3] + np.cross(rates[k, 3:], points - s.centroids[k]) for k in (a, b)]
            opening = (v[1] - v[0]) @ normal
            slip = np.linalg.norm(v[1] - v[0] - opening[:, None] * normal, axis=1)
            mu = known.get((min(a, b), max(a, b)), max(s.frictions(a, b) or {0.0}))
            worst, n = max(worst, float((mu * slip - opening).max())), n + len(points)
    return worst, n


def stands(s: Structure, file: h5py.Group, claim: float) -> tuple[list[str], str]:
    """Check the forces at the highest load held."""
    dead, live = file["standing_factors"][:]
    places = file["standing_places"][:]
    forces = Forces(s, file["standing_blocks"][:], file["standing_contacts"][:], s.placed(places), s.wide(places[:, : s.d]))
    faults, words = forces.faults(dead, live)
    return faults + _multiplier(dead, live, claim), words


def _multiplier(dead: float, live: float, claim: float) -> list[str]:
    same = abs(live / dead - claim) <= EXACT * max(abs(claim), 1e-6)
    return [] if same else [f"loads are those of a multiplier of {live / dead:.8g}, not of {claim:.8g}"]


def bound_forces(s: Structure, file: h5py.Group) -> Forces:
    """Forces at the bound, in the geometry as drawn."""
    places = np.hstack([s.centroids[:, : s.d], np.zeros((len(s.fixed), 1)) if s.d == 2
                        else np.tile([1.0, 0, 0, 0], (len(s.fixed), 1))])  # fmt: skip
    return Forces(s, file["mechanism_blocks"][:], file["mechanism_contacts"][:], s.placed(places), s.centroids)


def impossible(s: Structure, file: h5py.Group, claim: float) -> tuple[list[str], str]:
    """Check that no forces inside their cones balance more than the bound."""
    rates = s.generalised(file["mechanism_rates"][:])
    faults = ["the mechanism moves what is held"] if np.abs(rates[~s.free]).max(initial=0.0) > 0.0 else []
    blocks, mu = file["mechanism_blocks"][:], file["mechanism_contacts"][:, -1]
    known = {(min(a, b), max(a, b)): m for (a, b), m in zip(blocks.tolist(), mu, strict=True)}
    off, n = violation(s, rates, known)
    power, given = float((s.live * rates)[s.free].sum()), -float((s.dead * rates)[s.free].sum())
    if power <= 0.0:
        return [*faults, "live loads gain no power"], ""
    total = float(np.linalg.norm((s.dead + claim * s.live)[~s.fixed, :3], axis=1).sum())
    bound, more = given / power, off * total / power
    if abs(bound - claim) > HOLDS * abs(claim) or more > HOLDS * max(abs(claim), 1e-3):
        faults.append(f"the mechanism certifies {bound:.8g}, its inadmissible rates {more:.1g} more, not {claim:.8g}")
    return faults, f"{bound:.8g} from the power, inadmissible rates {more:.1e} more, {n} contacts found"


def fails(s: Structure, file: h5py.Group, claim: float) -> tuple[list[str], str]:
    """Check that the loads released more work than friction and joints took while blocks moved on."""
    (dead, live), places, energies = file["failing_factors"][:], file["failing_places"][:], file["failing_energies"][:]
    moved = s.generalised(np.zeros((len(s.fixed), len(s.dofs))))
    moved[:, :3] = s.wide(places[1, :, : s.d] - places[0, :, : s.d])
    for k, (a, b) in enumerate(zip(places[0, :, s.d :], places[1, :, s.d :], strict=True)):
        turn = rotation(b) @ rotation(a).T
        moved[k, 3:] = 0.5 * np.array([turn[2, 1] - turn[1, 2], turn[0, 2] - turn[2, 0], turn[1, 0] - turn[0, 1]])
    work = float(((dead * s.dead + live * s.live) * moved)[s.free].sum())
    given, taken = energies[1, 0] - energies[0, 0], float((energies[1] - energies[0])[1:3].sum())
    faults = _multiplier(dead, live, claim)
    if not work > taken:
        faults.append(f"the loads do {work:.3g} J and joints take {taken:.3g} J: nothing is released")
    far = np.abs(moved[:, :3]).max()
    return faults, f"blocks move {far:.2e} m, work {work:.4g} J (told {given:.4g} J), taken {taken:.4g} J"


def unique(s: Structure, file: h5py.Group, low: float, high: float) -> tuple[list[str], str]:
    """Check that friction takes no part in any mechanism whose work is the bound."""
    forces, (lower, upper) = bound_forces(s, file), file["mechanism_bounds"][:]
    faults, words = forces.faults(1.0, lower)
    limit = forces.friction * forces.normal
    carries = (forces.friction > 0.0) & (forces.normal > CARRIES * forces.normal.max())
    least = float(((limit - forces.shear)[carries] / limit[carries]).min(initial=1.0))
    share = max((upper - lower) / upper, LEAST_GAP) / max(least, 1e-300)
    if share > SLIDES:
        faults.append(f"friction may take {share:.1e} of the work of a mechanism, at most {SLIDES} is accepted")
    if not low - HOLDS * upper <= upper <= high + HOLDS * upper:
        faults.append("the bracket does not hold the bound")
    return faults, f"friction takes at most {share:.1e} of the work; {words}"


def check(path: str) -> list[Finding]:
    """Check all certificates of a file."""
    with h5py.File(path) as results:
        dem = results["dem"]
        if "certificates" not in dem:
            return [Finding("all", NONE, "there are no certificates")]
        file, s, found, loads = dem["certificates"], Structure(dem), [], {}
        for claim, test in (("stands", stands), ("impossible", impossible), ("fails", fails), ("unique", unique)):
            said = str(file.attrs[claim])
            if said.startswith("none: "):
                found.append(Finding(claim, NONE, said[6:]))
                continue
            if claim != "unique":
                loads[claim] = float(next(word for word in said.split() if word[0].isdigit()))
            given = (loads["stands"], loads["fails"]) if claim == "unique" else (loads[claim],)
            faults, words = test(s, file, *given)
            faults = s.faults + faults
            words = "; ".join(faults) if faults else f"{said}: " + "; ".join([words, *s.notes])
            found.append(Finding(claim, REFUSED if faults else PROVED, words))
    return found


if __name__ == "__main__":
    refused = False
    for name in sys.argv[1:]:
        for one in check(name):
            print(f"{name}: {one.claim} {one.verdict}: {one.words}")
            refused |= one.verdict == REFUSED
    sys.exit(int(refused))
