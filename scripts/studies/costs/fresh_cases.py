"""Seeded cases of every kind of analysis, that nothing was tuned to: what runs cost is measured on them."""

from __future__ import annotations

import math
import random
from collections.abc import Callable


class FreshCase:
    """A case file of one family, drawn by its seed: sizes evenly over their logarithm, all else evenly."""

    def __init__(self, family: str, seed: int) -> None:
        self.random = random.Random(f"{family} {seed}")
        self.family, self.seed = family, seed

    def text(self) -> str:
        """The case file."""
        return FAMILIES[self.family](self)

    # -- what is drawn -------------------------------------------------------------------------------------

    def number(self, least: float, most: float) -> float:
        """A number, to three figures."""
        return float(f"{self.random.uniform(least, most):.3g}")

    def count(self, least: int, most: int) -> int:
        """A number of blocks, evenly over its logarithm."""
        return round(math.exp(self.random.uniform(math.log(least), math.log(most))))

    def head(self, dimension: int, joints: str = "") -> str:
        """Materials, and joints of a friction that is drawn."""
        friction = self.number(0.45, 0.8)
        return (
            f"dimension = {dimension}\n[materials.stone]\ndensity = 2200.0\n"
            f"[joints.dry]\nfriction = {friction}\n{joints}\n"
        )

    def stiffness(self) -> str:
        """A kn that is given."""
        kn = float(f"{10 ** self.random.uniform(8.5, 10.5):.2g}")
        return f"kn = {kn:g}\nks = {0.4 * kn:g}\n"

    def wall(self, blocks: int, more: str = "", height: float = 0.3, thickness: float = 0.5) -> str:
        """A wall in running bond of about so many blocks."""
        shape = self.random.uniform(0.6, 1.8)  # courses over blocks of a course
        courses = max(2, round(math.sqrt(blocks * shape)))
        return (
            f'[[structure]]\nid = "w"\nkind = "wall"\nblock = [{self.number(0.4, 0.8)}, {height}]\n'
            f"courses = {courses}\nblocks_per_course = {max(2, round(blocks / courses))}\n"
            f"thickness = {thickness}\nbase_extension = 1.5\n{more}\n"
        )

    def openings(self, blocks: int) -> str:
        """A wall of about so many blocks with a door and a window under lintels."""
        length = 0.6 * max(9, round(math.sqrt(blocks * self.random.uniform(0.6, 1.2))))
        courses = max(8, round(blocks / (length / 0.6)))
        window = f"{{ x = {length - 2.1:.2f}, y = 0.9, width = 1.2, height = 0.9, {LINTEL} }}"
        door = f"{{ x = 1.2, y = 0.0, width = 1.2, height = 1.8, {LINTEL} }}"
        return (
            f'[[structure]]\nid = "w"\nkind = "wall"\nblock = [0.6, 0.3]\ncourses = {courses}\n'
            f"blocks_per_course = {round(length / 0.6)}\nthickness = 0.5\nbase_extension = 1.5\n"
            f"openings = [{door}, {window}]\n"
        )

    def rubble(self, cells: int, size: str) -> str:
        """A wall of stones of no order."""
        return (
            f'[[structure]]\nid = "w"\nkind = "voronoi-wall"\ncells = {cells}\nsize = {size}\nstretch = 1.5\n'
            f"relax = 4\nseed = {self.random.randint(1, 9999)}\nbase_height = 0.4\nbase_extension = 1.0\n"
        )

    def arch(self) -> str:
        """An arch on columns or on its springings."""
        columns = self.random.random() < 0.5
        stands = "included_angle_deg = 180.0\ncolumns = { width = 1.0, height = 1.5, courses = 5 }" if columns else (
            f"included_angle_deg = {self.number(110, 160)}"
        )  # fmt: skip
        return (
            f'[[structure]]\nid = "a"\nkind = "arch"\nvoussoirs = {self.count(9, 60)}\ninner_radius = 2.0\n'
            f"ring = {self.number(0.4, 0.6)}\nthickness = 0.5\nbase_extension = 1.0\n{stands}\n"
        )

    def column(self, blocks: int, dimension: int) -> str:
        """A column of drums."""
        width = self.number(0.5, 0.9)
        size = [width, 0.6] if dimension == 2 else [width, 0.6, width]
        return f'[[structure]]\nid = "c"\nkind = "column"\nblock = {size}\ncourses = {blocks}\nbase_extension = 1.5\n'

    def dome(self) -> str:
        """A dome on its drum."""
        return (
            '[[structure]]\nid = "d"\nkind = "vault"\nshape = "dome"\nradius = 4.0\n'
            f"thickness = {self.number(0.4, 0.6)}\n"
            f"courses = {self.random.randint(4, 7)}\nper_course = {self.random.choice((8, 12, 16))}\n"
            "oculus_radius = 0.6\ndrum = { width = 0.8, height = 1.0, courses = 2 }\n"
        )

    def house(self) -> str:
        """Four walls that are bonded at their corners, with a door and a window."""
        long, deep = 0.8 * self.random.randint(4, 6), 0.8 * self.random.randint(3, 5)
        courses = self.random.randint(6, 8)
        door = f"x = {0.4 * round(long):.2f}, y = 0.0, width = 0.8, height = 1.6"
        opening = f"openings = [{{ {door}, lintel = {{ height = 0.4, bearing = 0.3 }} }}]"
        walls = [
            ("front", [[0.0, 0.0], [long, 0.0]], opening),
            ("back", [[0.0, deep], [long, deep]], ""),
            ("left", [[0.0, 0.0], [0.0, deep]], ""),
            ("right", [[long, 0.0], [long, deep]], ""),
        ]
        head = (
            '[[structure]]\nkind = "building"\nid = "h"\nblock = [0.8, 0.4, 0.4]\n'
            f"courses = {courses}\nbase_extension = 1.2\n"
        )
        return head + "".join(
            f'[[structure.walls]]\nid = "{name}"\naxis = {axis}\n{more}\n' for name, axis, more in walls
        )

    def pushover(self, direction: str = "[1.0, 0.0]", more: str = "", follow: str | None = None) -> str:
        """Loads in proportion to the weight; the collapse is followed in one of two."""
        follow = follow or f"follow = {self.random.choice((0.0, 0.3))}"
        resolution = self.random.choice((0.002, 0.005, 0.01))
        return f'[analysis]\nkind = "pushover"\ndirection = {direction}\nresolution = {resolution}\n{follow}\n{more}\n'

    def shaken(self, seconds: float, direction: str = "[1.0, 0.0]") -> str:
        """A record, or a pulse."""
        if self.random.random() < 0.5:
            motion = (
                f'kind = "artificial"\nspectrum = "EC8-1"\nsoil = "B"\nag = {self.number(1.0, 6.0)}\n'
                f"duration = {seconds}\nrise = {0.2 * seconds:.3g}\nplateau = {0.6 * seconds:.3g}\n"
                f"seed = {self.random.randint(1, 999)}\n"
            )
        else:
            amplitude, frequency = self.number(1.0, 6.0), self.number(0.5, 2.0)
            motion = f'kind = "pulse"\nshape = "sine"\namplitude = {amplitude}\nfrequency = {frequency}\n'
        return f'[motion]\ndirection = {direction}\n{motion}[analysis]\nkind = "time-history"\nduration = {seconds}\n'


LINTEL = "lintel = { height = 0.3, bearing = 0.3 }"
OUT = "[0.0, -1.0, 0.0]"  # of a wall's plane
SIDES = 'sides = [{ face = "-y", strip = 0.5 }]'


def _dashpots(case: FreshCase) -> str:
    return case.random.choice(("", "[damping]\ncontact_fraction = 0.3\n"))


def _history(case: FreshCase, dimension: int) -> str:
    joints = case.random.choice(("", case.stiffness()))
    blocks = case.random.choice((case.count(2, 6), 0))
    size = (5, 60) if dimension == 2 else (5, 25)
    structure = case.column(blocks, dimension) if blocks else case.wall(case.count(*size))
    way = "[1.0, 0.0]" if dimension == 2 else OUT
    seconds = case.number(2.0, 8.0) if dimension == 2 else case.number(1.0, 4.0)
    return case.head(dimension, joints) + structure + _dashpots(case) + case.shaken(seconds, way)


def _settlement(case: FreshCase) -> str:
    moved = [case.number(-0.03, 0.03), case.number(-0.05, -0.01)]
    return (
        case.head(2, case.random.choice(("", case.stiffness())))
        + case.arch()
        + f'[[settlement]]\nblock = "a-base-right"\ndisplacement = {moved}\n[analysis]\nkind = "settlement"\n'
    )


def _curve(case: FreshCase) -> str:
    joints = case.random.choice(("", case.stiffness()))
    more = f'control = "displacement"\nfollow = {case.number(0.02, 0.2)}'
    return case.head(2, joints) + case.wall(case.count(12, 120)) + case.pushover(more=more, follow=" ")


def _cycle(case: FreshCase) -> str:
    blocks = case.count(4, 40)
    return (
        case.head(2, case.stiffness())
        + case.wall(blocks)
        + '[analysis]\nkind = "cycle"\npattern = "mass"\npath = [0.1, -0.1, 0.15]\nstep = 0.025\n'
    )


def _safety(case: FreshCase) -> str:
    structure = case.random.choice((case.wall(case.count(8, 100)), case.column(case.count(2, 8), 2), case.arch()))
    load = f"load = {case.number(0.02, 0.1)}\n"
    return case.head(2) + structure + f'[analysis]\nkind = "safety"\npattern = "mass"\n{load}'


def _thickness(case: FreshCase) -> str:
    return (
        case.head(2)
        + case.arch()
        + '[analysis]\nkind = "safety"\nvary = "structure.0.ring"\nbetween = [0.05, 1.0]\nresolution = 0.005\n'
    )


def _moving(case: FreshCase) -> str:
    return case.head(2) + case.wall(case.count(9, 80)) + case.pushover(more='kinematics = "large"')


def _moving_in_space(case: FreshCase) -> str:
    structure = case.wall(case.count(6, 20))
    return case.head(3) + structure + case.pushover(OUT, 'kinematics = "large"', "follow = 0")


FAMILIES: dict[str, Callable[[FreshCase], str]] = {
    "wall": lambda case: case.head(2) + case.wall(case.count(20, 800)) + case.pushover(),
    "openings": lambda case: case.head(2) + case.openings(case.count(80, 700)) + case.pushover(),
    "rubble": lambda case: (
        case.head(2) + case.rubble(case.count(20, 150), "[4.0, 3.0]\nthickness = 0.5") + case.pushover()
    ),
    "arch": lambda case: case.head(2) + case.arch() + case.pushover(),
    "given": lambda case: case.head(2, case.stiffness()) + case.wall(case.count(12, 150)) + case.pushover(),
    "moving": _moving,
    "curve": _curve,
    "cycle": _cycle,
    "settlement": _settlement,
    "safety": _safety,
    "thickness": _thickness,
    "gravity": lambda case: case.head(2) + case.openings(case.count(80, 800)) + '[analysis]\nkind = "gravity"\n',
    "modes": lambda case: (
        case.head(2, case.stiffness()) + case.wall(case.count(10, 200)) + '[analysis]\nkind = "modes"\n'
    ),
    "history": lambda case: _history(case, 2),
    "wall in space": lambda case: case.head(3) + case.wall(case.count(20, 250), SIDES) + case.pushover(OUT),
    "rubble in space": lambda case: (
        case.head(3) + case.rubble(case.count(20, 60), f"[4.0, 2.5, 0.5]\n{SIDES}") + case.pushover(OUT)
    ),
    "house": lambda case: case.head(3) + case.house() + case.pushover(OUT),
    "dome": lambda case: case.head(3) + case.dome() + case.pushover("[1.0, 0.0, 0.0]"),
    "given in space": lambda case: (
        case.head(3, case.stiffness()) + case.wall(case.count(6, 40), SIDES) + case.pushover(OUT)
    ),
    "moving in space": _moving_in_space,
    "history in space": lambda case: _history(case, 3),
    "gravity in space": lambda case: case.head(3) + case.house() + '[analysis]\nkind = "gravity"\n',
}
