"""Damage to cases: numbers that are huge, tiny, negative or none, wrong types, keys lost or strayed, torn text."""

from __future__ import annotations

import copy
import random
from collections.abc import Iterator
from typing import Any

import tomli_w

WORDS = ["", "*", "x", "auto", "none", "all", "stone", "dry", "s", "wall", "é\n\"'", "a" * 300, "pushover", "large"]
ODD = [
    0,
    -1,
    1,
    True,
    1e-300,
    1e300,
    float("nan"),
    float("inf"),
    2**63,
    1e30,
    1e-9,
    1e9,
    0.5,
    "x",
    "",
    [],
    {},
    [[0.0, 0.0]],
]
TYPED = "[]{}\"'=.,#\n 1a-\\\x00é"


def places(value: Any) -> Iterator[tuple[Any, Any]]:
    """Holder and key of everything in plain data."""
    for key, item in list(value.items() if isinstance(value, dict) else enumerate(value)):
        yield value, key
        if isinstance(item, (dict, list)):
            yield from places(item)


def other_number(rng: random.Random, value: float) -> Any:
    """A number in place of this one: near it, of another size or sign, or odd."""
    new = rng.choice(
        [
            value * 10.0 ** rng.randint(-12, 12),
            value * rng.uniform(0.3, 3.0),
            -value,
            value + rng.choice([1e-9, 1e-3, 1, -1]),
        ]
    )
    whole = isinstance(value, int) and abs(new) < 2**62 and rng.random() < 0.8
    return rng.choice(ODD) if rng.random() < 0.15 else int(new) if whole else new


def other_list(rng: random.Random, value: list[Any]) -> Any:
    """A list in place of this one: an entry more or less, in another order, or something else."""
    changed = [copy.deepcopy(entry) for entry in value]
    how = rng.randrange(4)
    if not value or how == 3:
        return rng.choice(ODD)
    if how == 0:
        return [*changed, copy.deepcopy(rng.choice(value))]
    rng.shuffle(changed)
    return changed if how == 1 else changed[1:]


def damaged(rng: random.Random, tables: dict[str, Any], other: dict[str, Any]) -> str:
    """The text of a case with one to four faults; `other`: a case whose tables may stray into it."""
    tables = copy.deepcopy(tables)
    for _ in range(rng.choice([1, 1, 1, 2, 2, 3, 4])):
        holder, key = rng.choice(list(places(tables)) or [(tables, "title")])
        value, how = holder[key] if tables else "", rng.random()
        if how < 0.12 and isinstance(holder, dict) and holder:
            item = holder.pop(key)
            if rng.random() < 0.3:
                holder[rng.choice([key[:-1] or "k", key + "s", rng.choice(list(other))])] = item
        elif how < 0.24:
            key = rng.choice(list(other))
            both = isinstance(other[key], list) and isinstance(tables.get(key), list)
            tables[key] = copy.deepcopy(tables[key] + other[key] if both else other[key])
        elif isinstance(value, (int, float)) and not isinstance(value, bool):
            holder[key] = other_number(rng, value)
        elif isinstance(value, list):
            holder[key] = other_list(rng, value)
        elif how < 0.6 or not isinstance(value, dict):
            holder[key] = rng.choice(WORDS if isinstance(value, str) and how < 0.9 else ODD)
    text = tomli_w.dumps(tables)
    if rng.random() < 0.06:
        at, length = rng.randrange(len(text)), rng.randint(0, 5)
        text = text[:at] + "".join(rng.choices(TYPED, k=rng.randint(0, 3))) + text[at + length :]
    return text
