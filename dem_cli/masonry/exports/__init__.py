"""Blocks of a case for other programs: OBJ, STL, glTF, compas JSON, DXF, and the input of LMGC90 and 3DEC."""
