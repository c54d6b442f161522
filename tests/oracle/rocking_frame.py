"""Rocking frame: free-standing columns capped by a free beam, which rock as one block of larger size and less loss.

N equal columns (half diagonal R, tan α = width / height, m each) turn by the same θ on rigid ground without slip; the
beam, γ N m, touches each at the corner across from where it stands, and translates. Lagrange's equation is that of
Housner's block with (Makris and Vassiliou 2013, "Planar rocking response and stability analysis of an array of
free-standing columns capped with a freely supported rigid beam", Earthquake Engng Struct. Dyn. 42, 431–449)

    p̂² = p² (1 + 2γ) / (1 + 3γ),   ω⁺/ω⁻ = (1 − 1.5 sin² α + 3γ cos 2α) / (1 + 3γ)

`tests/verification/test_oracle_dynamics.py` finds both again from the bodies by themselves.
"""

from __future__ import annotations

from math import cos, sin

from oracle.housner import Block


def equivalent(column: Block, beam: float) -> Block:
    """Housner's block that rocks as the frame does; beam: its mass over that of all columns, γ."""
    return Block.of(column.alpha, column.p * ((1.0 + 2.0 * beam) / (1.0 + 3.0 * beam)) ** 0.5, column.gravity)


def restitution(column: Block, beam: float) -> float:
    """Angular velocity after over before an impact; that of the column alone where the beam has no mass."""
    return (1.0 - 1.5 * sin(column.alpha) ** 2 + 3.0 * beam * cos(2.0 * column.alpha)) / (1.0 + 3.0 * beam)
