"""What must be true of a case's failure loads, and what is not."""

from __future__ import annotations

from studies.loads.methods import CaseLoads, MethodLoad

AGREES = 0.01  # DEM against the path, over the latter
ABOVE = 0.005  # of the associated load, by which any other may lie above it


def reference(row: CaseLoads) -> float | None:
    """Load of joints that do not dilate: that of `dem limit`, else the highest of the fine path; None without any."""
    if row.path is not None and row.path.load is not None:
        return row.path.load
    return row.fine.high if row.fine is not None and row.fine.load is not None else None


def error(row: CaseLoads, way: MethodLoad | None) -> float | None:
    """Of a way, over the reference."""
    load = reference(row)
    return way.load / load - 1.0 if way is not None and way.load is not None and load else None


def problems(row: CaseLoads) -> list[str]:
    """What is wrong with a row, a sentence each; nothing where all is well."""
    bound, found = row.associated.high, []
    if row.associated.status != "ok":
        if row.gravity.status == "ok":
            found.append(f"DEM fails at {row.gravity.load:.5g}, limit analysis: {row.associated.status}")
        return found
    if reference(row) is None:
        found.append(f"no path: {row.path.status}")
    for name, way in (("raised from gravity", row.gravity), ("as dem run", row.default)):
        if way is None:
            continue
        if way.status != "ok":
            found.append(f"DEM {name}: {way.status}, {way.load} to {way.high}")
        off = error(row, way)
        if off is not None and abs(off) > AGREES:
            found.append(f"DEM {name} differs from the path by {100 * off:+.2f} %")
    for name, way in (("DEM raised from gravity", row.gravity), ("DEM as dem run", row.default), ("path", row.path)):
        if way is not None and way.load is not None and way.load > (1.0 + ABOVE) * bound:
            found.append(f"{name} is {100 * (way.load / bound - 1.0):.2f} % above the associated load")
    return found
