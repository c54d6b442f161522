"""Time histories: real masses, ground motion, damping, frequencies, collapse."""
