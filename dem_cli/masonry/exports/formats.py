"""Export formats by the ending of the file name: meshes, drawings, and input of other programs."""

from __future__ import annotations

from collections.abc import Callable
from pathlib import Path
from typing import NamedTuple

from dem_cli.errors import UsageError
from dem_cli.masonry.exports.compas_json import compas_json
from dem_cli.masonry.exports.contents import ExportedCase
from dem_cli.masonry.exports.drawing import dxf
from dem_cli.masonry.exports.gltf import glb, gltf
from dem_cli.masonry.exports.itasca_3dec import itasca_3dec
from dem_cli.masonry.exports.lmgc90 import lmgc90
from dem_cli.masonry.exports.meshes import obj, stl
from dem_cli.results.output.atomic_file import whole
from dem_cli.results.output.folder import write_error
from dem_cli.results.output.paraview.vtk import write_geometry

Written = tuple[str | bytes, list[str]]  # what goes into the file, and what of the case does not


class ExportFormat(NamedTuple):
    """Export format with its description and writer."""

    what: str
    write: Callable[[ExportedCase, str], Written]  # a case, the name of the file


def _plain(
    write: Callable[[ExportedCase], str | bytes], compounds: bool = True
) -> Callable[[ExportedCase, str], Written]:
    """Wrap a writer of a format that carries all blocks; notes compounds where it has none of them."""
    return lambda exported, file: (write(exported), [] if compounds else _apart(exported))


def _apart(exported: ExportedCase) -> list[str]:
    found = [block.id for block in exported.blocks if len(block.parts) > 1]
    more = f" and {len(found) - 1} more" if len(found) > 1 else ""
    return [f"that the parts of '{found[0]}'{more} are one block"] if found else []


EXPORT_FORMATS = {
    ".obj": ExportFormat("OBJ, an object for each block", _plain(obj)),
    ".stl": ExportFormat("STL, a solid for each block", _plain(stl, compounds=False)),
    ".glb": ExportFormat("glTF, for viewers", _plain(glb)),
    ".gltf": ExportFormat("glTF as text", _plain(gltf)),
    ".json": ExportFormat("COMPAS meshes", _plain(compas_json)),
    ".dxf": ExportFormat("DXF, a closed polyline for each block of a case in 2D", _plain(dxf, compounds=False)),
    ".lmgc90.py": ExportFormat("LMGC90, a script for pylmgc90", lmgc90),
    ".3ddat": ExportFormat("3DEC, a data file", lambda exported, file: itasca_3dec(exported)),
}


def ending(path: Path) -> str | None:
    """Return the export format of a file name; None: not one of these."""
    name = path.name.lower()
    return next((suffix for suffix in EXPORT_FORMATS if name.endswith(suffix)), None)


def write_case(path: Path, exported: ExportedCase) -> list[str]:
    """Export a case to a file; .vtu and unknown endings go to meshio. Returns what the format does not carry.

    Raises UsageError, OutputError.
    """
    suffix = ending(path)
    if suffix is None:
        if path.suffix.lower() == ".py":
            raise UsageError(f"{path}: a script for LMGC90 is called {path.stem}.lmgc90.py")
        write_geometry(path, exported.model)
        return []
    text, notes = EXPORT_FORMATS[suffix].write(exported, path.name)
    try:
        path.parent.mkdir(parents=True, exist_ok=True)
    except OSError as error:
        raise write_error(error, path) from None
    with whole(path) as part:
        part.write_bytes(text if isinstance(text, bytes) else text.encode("utf-8"))
    return notes
