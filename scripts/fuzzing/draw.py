"""Random numbers of a seed in the forms that case files are made of."""

from __future__ import annotations

import random
from typing import Any

Tables = dict[str, Any]


class Draw(random.Random):
    """Random numbers in the forms that cases are made of; `space`: whether the case is in 3D."""

    space = False

    def size(self, low: float, high: float) -> float:
        """A number with three digits, as people write them."""
        return float(f"{self.uniform(low, high):.3g}")

    def power(self, low: float, high: float) -> float:
        """A number whose decimal logarithm lies between these."""
        return float(f"{10 ** self.uniform(low, high):.3g}")

    def some(self, share: float, **keys: Any) -> Tables:
        """These keys in that share of cases; values that are functions are called then."""
        if self.random() >= share:
            return {}
        return {key: value() if callable(value) else value for key, value in keys.items()}

    def point(self, x: float, up: float) -> list[float]:
        """A point of the elevation."""
        return [x, 0.0, up] if self.space else [x, up]

    def vector(self, size: float) -> list[float]:
        """A force or direction, more often down than up."""
        return [self.size(-size, size) for _ in range(1 + self.space)] + [self.size(-size, 0.3 * size)]
