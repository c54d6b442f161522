"""Write files for ParaView and pyvista: fields of blocks, contacts and joints, as VTKHDF and legacy VTK."""
