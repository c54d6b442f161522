"""Import blocks of other programs, STL, OBJ, PLY, compas JSON, DXF and SVG, as corners and faces."""
