"""Export a case in the plane as a DXF drawing (ezdxf): a closed polyline per block, layers by material."""

from __future__ import annotations

import io

from dem_cli.errors import MissingExtra, UsageError
from dem_cli.masonry.exports.contents import ExportedCase

GROUND = "fixed"  # layer of blocks that cannot move
NOT_IN_NAMES = '<>/\\":;?*=`|'  # of layers


def dxf(exported: ExportedCase) -> str:
    """Write the DXF drawing in metres. Raises UsageError for a case in space."""
    if exported.case.dimension == 3:
        raise UsageError("a DXF drawing is of a case in 2D; in 3D .obj, .glb and others have the blocks")
    try:
        import ezdxf
    except ImportError:
        raise MissingExtra("writing DXF files needs ezdxf", "import") from None
    drawing = ezdxf.new("R2000", units=6)
    space = drawing.modelspace()
    for block in exported.blocks:
        layer = GROUND if block.fixed else "".join("_" if sign in NOT_IN_NAMES else sign for sign in block.material)
        if layer not in drawing.layers:
            drawing.layers.add(layer)
        for part in block.parts:
            space.add_lwpolyline([tuple(corner) for corner in part.tolist()], close=True, dxfattribs={"layer": layer})
    text = io.StringIO()
    drawing.write(text)
    return text.getvalue()
