"""Files of a run that ParaView and pyvista open: fields of blocks, contacts and joints, as VTKHDF and legacy VTK."""
