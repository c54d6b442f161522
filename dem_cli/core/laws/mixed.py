"""Several joint laws in one model: each joint selects its law by a number in its last column."""

from __future__ import annotations

from collections.abc import Callable, Sequence
from functools import cache

import numpy as np

from dem_cli.core.kernels.jit import inline, named
from dem_cli.core.laws.envelope import Envelope, envelope
from dem_cli.core.laws.law import Law
from dem_cli.declarations import Parameters


@cache
def mixed(laws: tuple[Law, ...]) -> Law:
    """Combine several laws into one: the parameters of each, filled up with zeros, then the number of its law.

    The columns of a joint are made by `row`, not by the record.
    """
    if len(laws) == 1:
        return laws[0]
    function = laws[-1].function
    for number in range(len(laws) - 2, -1, -1):
        function = _either(number, laws[number].function, function)

    def each(which):
        def of_all(parameters, values, memory, kn):
            found = np.zeros(len(values))
            for number, law in enumerate(laws):
                own = parameters[:, -1] == number
                found[own] = which(law)(parameters[own], values[own], memory[own], kn[own])
            return found

        return of_all

    def joined(which):
        def of_all(parameters, kn) -> Envelope:
            whole = envelope(len(kn))
            for number, law in enumerate(laws):
                own = parameters[:, -1] == number
                for values, found in zip(whole, which(law)(parameters[own], kn[own]), strict=True):
                    values[own] = found
            return whole

        return of_all

    straight, falls = all(law.envelope for law in laws), any(law.residual for law in laws)
    return Law(
        name=" + ".join(law.name for law in laws),
        parameters=Parameters,
        function=function,
        columns=lambda table, kn: (),
        shear_limit=each(lambda law: law.shear_limit),
        pressed=each(lambda law: law.pressed),
        envelope=joined(lambda law: law.envelope) if straight else None,
        residual=joined(lambda law: law.residual or law.envelope) if straight and falls else None,
        scalars=max(law.scalars for law in laws),
        vectors=max(law.vectors for law in laws),
        bonded=any(law.bonded for law in laws),
    )


def row(laws: Sequence[Law], law: Law, columns: Sequence[float], width: int) -> np.ndarray:
    """Make the parameters of a joint with this law, `width` columns and, where laws are mixed, its number last."""
    if len(laws) == 1:
        return np.array(columns, float)
    return np.array([*columns, *[0.0] * (width - len(columns)), float(laws.index(law))])


def _either(number: int, this: Callable, others: Callable) -> Callable:
    """Choose `this` law where the last column is `number`, else one of the others."""

    @inline
    def either(gap, slide, shear, kn, ks, parameters, joint, memory, point):
        if parameters[joint, parameters.shape[1] - 1] == number:
            return this(gap, slide, shear, kn, ks, parameters, joint, memory, point)
        return others(gap, slide, shear, kn, ks, parameters, joint, memory, point)

    return named(either, str(number), this, others)
