"""Import DXF drawings (ezdxf): closed polylines, and loops of single lines, as outlines; layers are kept."""

from __future__ import annotations

from collections import Counter
from collections.abc import Collection, Iterable
from pathlib import Path
from typing import Any, NamedTuple

import numpy as np

from dem_cli.errors import MissingExtra
from dem_cli.masonry.imports.contents import Contents, FileBody, FileProblem, finite, written_out

UNITS = {0: "", 1: "in", 2: "ft", 4: "mm", 5: "cm", 6: "m", 14: "dm"}  # of $INSUNITS; 0: it says none
OUTLINES, PIECES = ("LWPOLYLINE", "POLYLINE"), ("LINE", "ARC")
_MODEL_SPACE = "*Model_Space"
_SAME = 1e-9  # of the size of a drawing: ends of lines that meet


class _Piece(NamedTuple):
    """Open line of a DXF drawing that may form an outline with others."""

    layer: str
    ring: np.ndarray  # corners along it, (n, 2)
    said: str  # its kind and handle


def read(path: Path, chords: int | None = None, only: Collection[str] = (), skip: Collection[str] = ()) -> Contents:
    """Read the outlines of a DXF drawing. Raises FileProblem.

    only: layers that are read, others are left out; (): all. skip: layers that are left out.
    """
    drawing = _drawing(path)
    hidden = {layer.dxf.name for layer in drawing.layers if layer.is_off() or layer.is_frozen()}
    left_out: Counter[str] = Counter()
    bodies, pieces, layers = [], [], {}
    for entity in _entities(drawing):
        kind, layer = entity.dxftype(), entity.dxf.layer
        layers[layer] = True
        if layer in skip or (only and layer not in only):
            left_out[f"on layer '{layer}'"] += 1
        elif layer in hidden:
            left_out[f"{kind} on layer '{layer}', which is off"] += 1
        elif kind in OUTLINES and (kind == "LWPOLYLINE" or entity.is_2d_polyline or entity.is_3d_polyline):
            piece = _piece(entity, chords)
            if _closed(entity, piece.ring):
                bodies.append(_body(piece.ring, layer, piece.said))
            else:
                pieces.append(piece)
        elif kind in PIECES:
            pieces.append(_piece(entity, chords))
        else:
            left_out[kind] += 1
    bodies += _loops(pieces)
    words = [f"{count} {what}" for what, count in left_out.items()]
    return Contents(bodies, _unit(drawing.header.get("$INSUNITS", 0)), words, layers=list(layers))


def _drawing(path: Path) -> Any:
    try:
        import ezdxf
    except ImportError:
        raise MissingExtra("reading DXF files needs ezdxf", "import") from None
    try:
        return ezdxf.readfile(path)
    except Exception as error:  # of ezdxf: whatever its reader stumbles over
        raise FileProblem(f"not a DXF file that can be read ({str(error) or type(error).__name__})") from None


def _unit(code: int) -> str:
    """Return the unit of length that a drawing declares, even one that is not supported."""
    from ezdxf.enums import InsertUnits

    if code in UNITS:
        return UNITS[code]
    known = {int(each): each.name.lower() for each in InsertUnits}
    return f"{known.get(code, 'units')} ($INSUNITS = {code})"


def _entities(drawing: Any) -> Iterable[Any]:
    """Yield the entities of the model space with block references expanded."""
    from ezdxf import disassemble

    written_out(_MODEL_SPACE, lambda name: _parts(drawing, name))
    return disassemble.recursive_decompose(drawing.modelspace())


def _parts(drawing: Any, name: str) -> Iterable[tuple[str | None, int]]:
    """Yield the shapes and block references of the model space or of a block of a drawing."""
    inside = drawing.modelspace() if name == _MODEL_SPACE else drawing.blocks.get(name)
    for entity in inside or ():
        if entity.dxftype() != "INSERT":
            yield None, 1
            continue
        try:
            if entity.dxf.insert is None:
                raise ValueError("it stands nowhere")
            times = max(int(entity.dxf.row_count), 1) * max(int(entity.dxf.column_count), 1)
        except (AttributeError, TypeError, ValueError) as error:
            raise FileProblem(f"a reference to the block '{entity.dxf.name}' is damaged ({error})") from None
        yield str(entity.dxf.name), times


def _path(entity: Any) -> Any:
    from ezdxf import path

    try:
        return path.make_path(entity)
    except Exception as error:  # of ezdxf: a polyline without points, and so on
        raise FileProblem(f"a {entity.dxftype()} of layer '{entity.dxf.layer}' has no shape ({error})") from None


def _piece(entity: Any, chords: int | None) -> _Piece:
    handle = entity.dxf.handle  # None within a block reference
    said = entity.dxftype() + (f" #{handle}" if handle else "")
    return _Piece(entity.dxf.layer, _ring(_path(entity), entity.dxf.layer, chords), said)


def _closed(entity: Any, ring: np.ndarray) -> bool:
    """Test whether a polyline is closed by its flag, or ends where it begins."""
    return bool(entity.is_closed) or bool(np.abs(ring[0] - ring[-1]).max() <= _SAME * np.abs(ring).max())


def _ring(path: Any, layer: str, chords: int | None) -> np.ndarray:
    """Return the corners along a path, (n, 2)."""
    from ezdxf.path import Command

    points, start = [path.start], path.start
    for command in path.commands():
        if command.type in (Command.CURVE3_TO, Command.CURVE4_TO):
            if chords is None:
                raise FileProblem(
                    f"a curve on layer '{layer}' from [{start.x:g}, {start.y:g}]; blocks have straight sides: "
                    "give chords, into how many of them each quarter of a circle is cut"
                )
            points += _curve(start, command, chords)
        else:
            points.append(command.end)
        start = command.end
    return finite([[point.x, point.y] for point in points], f"layer '{layer}'")


def _curve(start: Any, command: Any, chords: int) -> list[Any]:
    from ezdxf.math import Bezier3P, Bezier4P

    inner = [command.ctrl] if hasattr(command, "ctrl") else [command.ctrl1, command.ctrl2]
    bezier = (Bezier3P if len(inner) == 1 else Bezier4P)([start, *inner, command.end])
    return [*(bezier.point(k / chords) for k in range(1, chords)), command.end]


def _loops(pieces: list[_Piece]) -> list[FileBody]:
    """Join lines that meet end to end on one layer to outlines. Raises FileProblem where they do not close."""
    from ezdxf import edgeminer
    from ezdxf.math import Vec3

    found, by_layer = [], dict[str, list[_Piece]]()
    for piece in pieces:
        by_layer.setdefault(piece.layer, []).append(piece)
    for layer, own in by_layer.items():
        size = float(np.abs(np.concatenate([piece.ring for piece in own])).max()) or 1.0
        edges = [
            edgeminer.make_edge(Vec3(*piece.ring[0]), Vec3(*piece.ring[-1]), _length(piece.ring), payload=piece)
            for piece in own
            if _length(piece.ring) > _SAME * size
        ]
        deposit = edgeminer.Deposit(edges, gap_tol=_SAME * size)
        for chain in edgeminer.find_all_simple_chains(deposit):
            if not edgeminer.is_loop(chain, gap_tol=_SAME * size):
                raise FileProblem(f"layer '{layer}': {_open_end(deposit, chain)}")
            ring = [edge.payload.ring[:: -1 if edge.is_reverse else 1] for edge in chain]
            found.append(_body(np.concatenate([piece[:-1] for piece in ring]), layer, chain[0].payload.said))
    return found


def _open_end(deposit: Any, chain: Any) -> str:
    ends = ((chain[0], chain[0].start), (chain[-1], chain[-1].end))
    edge, point = next((end for end in ends if deposit.degree(end[1]) != 2), ends[-1])
    count = deposit.degree(point)
    how = "ends" if count < 2 else f"meets {count - 1} others"
    return (
        f"{edge.payload.said} {how} at [{point.x:g}, {point.y:g}]; an outline is a closed polyline, "
        "or lines that meet in twos"
    )


def _length(ring: np.ndarray) -> float:
    return float(np.hypot(*np.diff(ring, axis=0).T).sum())


def _body(ring: np.ndarray, layer: str, said: str) -> FileBody:
    """Create an outline without a repeated last corner."""
    same = len(ring) > 1 and np.abs(ring[0] - ring[-1]).max() <= _SAME * np.abs(ring).max()
    return FileBody("", ring[:-1] if same else ring, layer=layer, said=said)
