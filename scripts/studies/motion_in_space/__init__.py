"""Study of blocks that move in space: closed forms, integrals, planar twins, structures and their books of energy."""
