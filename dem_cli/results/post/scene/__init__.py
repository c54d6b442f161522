"""Draw structures with matplotlib: polygons in the plane, solids in space seen from the side that moves."""
