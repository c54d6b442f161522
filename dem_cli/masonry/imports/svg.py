"""Import SVG drawings (svgelements): rectangles, polygons and closed paths as outlines; groups are layers.

One unit of the drawing is one unit of length: numbers as they stand in the file, transformations applied, size and
viewBox of the page left out. y runs downwards in SVG; outlines run upwards.
"""

from __future__ import annotations

import io
from collections import Counter
from collections.abc import Collection, Iterator
from pathlib import Path
from typing import Any
from xml.etree import ElementTree

import numpy as np

from dem_cli.errors import MissingExtra
from dem_cli.masonry.imports.contents import Contents, FileBody, FileProblem, finite, written_out

LABEL = "{http://www.inkscape.org/namespaces/inkscape}label"
_HREF = ("href", "{http://www.w3.org/1999/xlink}href")
_PAGE = ("width", "height", "viewBox", "x", "y", "preserveAspectRatio")


def read(path: Path, chords: int | None = None, only: Collection[str] = (), skip: Collection[str] = ()) -> Contents:
    """Read the outlines of an SVG drawing. Raises FileProblem.

    only: groups (layers) that are read, others are left out; (): all. skip: groups that are left out.
    """
    left_out: Counter[str] = Counter()
    bodies, layers = [], {}
    for name, layer, shape in _shapes(_parsed(path, left_out), "", left_out):
        layers[layer] = True
        if layer in skip or (only and layer not in only):
            left_out[f"on group '{layer}'" if layer else "on no group"] += 1
            continue
        for ring in _rings(shape, name, chords):
            ring = finite(ring, f"'{name}'") * (1.0, -1.0)
            bodies.append(FileBody(name, ring, layer=layer, said=f"'{name}'" if name else ""))
    words = [f"{count} {what}" for what, count in left_out.items() if count]
    return Contents(bodies, left_out=words, layers=list(layers))


def _parsed(path: Path, left_out: Counter[str]) -> Any:
    try:
        from svgelements import SVG, Group
    except ImportError:
        raise MissingExtra("reading SVG files needs svgelements", "import") from None
    try:
        root = ElementTree.parse(path).getroot()
        if not str(root.tag).endswith("svg"):
            raise FileProblem(f"<{root.tag}>, not an SVG drawing")
        for key in _PAGE:
            root.attrib.pop(key, None)
        left_out["hidden"] += sum(map(_is_hidden, root.iter()))
        _check_uses(root)
        drawn = SVG.parse(io.BytesIO(ElementTree.tostring(root)), reify=True)
        if not isinstance(drawn, Group):  # of another namespace
            raise FileProblem(f"<{root.tag}>, not an SVG drawing")
        return drawn
    except FileProblem:
        raise
    except Exception as error:  # of the parsers: whatever they stumble over
        raise FileProblem(f"not an SVG drawing that can be read ({str(error) or type(error).__name__})") from None


def _check_uses(root: Any) -> None:
    """Raise FileProblem where the repetition of <use> has no end, or is too much."""
    named = {f"#{element.get('id')}": element for element in root.iter() if element.get("id")}

    def parts(name: str) -> Iterator[tuple[str | None, int]]:
        for element in named.get(name, root).iter():
            used = next((element.get(key) for key in _HREF if element.get(key)), None)
            yield (used, 1) if used in named else (None, 1)

    written_out("", parts)


def _is_hidden(element: Any) -> bool:
    """Test whether a group or shape is not displayed, such as a layer that is off."""
    style = element.get("style", "").replace(" ", "")
    return element.get("display") == "none" or "display:none" in style.split(";")


def _shapes(group: Any, layer: str, left_out: Counter[str]) -> Iterator[tuple[str, str, Any]]:
    """Yield name, group and shape of everything that is drawn; the outermost group with a name counts."""
    from svgelements import Group, Path, Shape, Use

    for each in group:
        if isinstance(each, (Group, Use)):
            label = each.values.get("attributes", {}).get(LABEL) or each.id or ""
            yield from _shapes(each, layer or (str(label) if isinstance(each, Group) else ""), left_out)
        elif isinstance(each, Shape) and len(shape := Path(each)):
            yield str(each.id or ""), layer, shape
        else:
            left_out[type(each).__name__.lower()] += 1


def _rings(shape: Any, name: str, chords: int | None) -> Iterator[np.ndarray]:
    """Yield the corners of each closed piece of a path. Raises FileProblem where it is open or curved."""
    from svgelements import Close, Line, Move, Path

    for piece in shape.as_subpaths():
        points: list[Any] = []
        closed = False
        for segment in Path(piece):
            if isinstance(segment, Move):
                points.append(segment.end)
            elif isinstance(segment, Close):
                closed = True
            elif isinstance(segment, Line):
                points.append(segment.end)
            elif chords is None:
                raise FileProblem(f"'{name}' has a curve; blocks have straight sides: give chords, how many for each")
            else:
                points += [segment.point(k / chords) for k in range(1, chords + 1)]
        ring = np.array([[point.x, point.y] for point in points], float)
        same = len(ring) > 1 and np.abs(ring[0] - ring[-1]).max() <= 1e-9 * np.abs(ring).max()
        if not closed and not same:
            x, y = ring[-1] if len(ring) else (0.0, 0.0)
            raise FileProblem(f"'{name}' is not closed: it ends at [{x:g}, {y:g}]")
        yield ring[:-1] if same else ring
