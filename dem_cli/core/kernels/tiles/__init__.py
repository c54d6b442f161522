"""Contact forces in tiles: sixteen joints side by side, which the processor works on at once (SIMD); threads over
tiles.
"""
