"""Files of other programs that hold blocks: STL, OBJ, PLY, compas JSON, DXF and SVG, read into corners and faces."""
