"""Export blocks of a case to other programs: OBJ, STL, glTF, compas JSON, DXF, and input of LMGC90 and 3DEC."""
