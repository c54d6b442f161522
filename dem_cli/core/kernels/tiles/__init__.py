"""Contact points in tiles: sixteen joints side by side, which the processor works on at once; threads over tiles."""
