"""Import formats by the ending of the file name: solids in space, or outlines in a plane."""

from __future__ import annotations

from collections.abc import Callable, Collection
from importlib import import_module
from pathlib import Path
from typing import NamedTuple

from dem_cli.masonry.imports.contents import Contents, FileProblem, check_file, check_shapes


class FileFormat(NamedTuple):
    """Import format with its reader and description."""

    module: str  # its reader, imported when it is used
    flat: bool  # outlines in a plane, not solids
    what: str


FORMATS = {
    ".stl": FileFormat("dem_cli.masonry.imports.stl", False, "solids"),
    ".obj": FileFormat("dem_cli.masonry.imports.obj", False, "objects"),
    ".ply": FileFormat("dem_cli.masonry.imports.ply", False, "solids"),
    ".json": FileFormat("dem_cli.masonry.imports.compas_json", False, "meshes"),
    ".dxf": FileFormat("dem_cli.masonry.imports.dxf", True, "outlines"),
    ".svg": FileFormat("dem_cli.masonry.imports.svg", True, "outlines"),
}


def format_of(file: str | Path) -> FileFormat | None:
    """Return the import format of a file name; None: not supported."""
    return FORMATS.get(Path(file).suffix.lower())


def read(
    file: str | Path, chords: int | None = None, only: Collection[str] = (), skip: Collection[str] = ()
) -> Contents:
    """Read all bodies of a file, of a drawing on the layers `only`; (): on all except `skip`. Raises FileProblem.

    chords: straight pieces of a curve in a drawing.
    """
    path, found = Path(file), format_of(file)
    if found is None:
        raise FileProblem(f"'{path.suffix}' is not read; allowed: {', '.join(FORMATS)}")
    reader: Callable[..., Contents] = import_module(found.module).read
    try:
        check_file(path)
        contents = reader(path, chords, only, skip) if found.flat else reader(path)
    except OSError as error:
        raise FileProblem(f"cannot be read ({error.strerror or error})") from None
    check_shapes(contents.bodies)
    absent = [name for name in only if name not in contents.layers]
    if absent:
        drawn = ", ".join(f"'{name}'" for name in contents.layers if name) or "none"
        raise FileProblem(f"nothing is drawn on a layer '{absent[0]}'; layers with something on them: {drawn}")
    if not contents.bodies:
        also = f"; left out: {', '.join(contents.left_out)}" if contents.left_out else ""
        raise FileProblem(f"no {found.what} in it{also}")
    return contents
