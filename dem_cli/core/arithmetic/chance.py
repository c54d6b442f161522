"""Random numbers that a case can repeat: drawn from its seed and from names, whatever else there is in the case."""

from __future__ import annotations

import hashlib
import math


def chance(*words: str | int) -> float:
    """Draw a number between 0 and 1, both excluded, evenly and from these words alone: seed, key, names."""
    digest = hashlib.blake2b(" ".join(map(str, words)).encode(), digest_size=8).digest()
    return ((int.from_bytes(digest, "big") >> 12) + 0.5) / 2.0**52


def lognormal_factor(variation: float, *words: str | int) -> float:
    """Draw a log-normal factor above 0 with mean 1 and coefficient of variation `variation` [-] from these words."""
    from statistics import NormalDist

    variance = math.log1p(variation**2)
    return math.exp(math.sqrt(variance) * NormalDist().inv_cdf(chance(*words)) - 0.5 * variance)
