"""The campaign of the localizer with the laws kept: its three journeys with each single and each double fault that breaks no law.

python -m benchmarks.laws_kept 2400 > laws-kept.toml        2400 vehicles in each situation: 10^9 vehicle-cycles
safeloc campaign laws-kept.toml --out found
"""

from __future__ import annotations

import sys
from collections.abc import Iterator, Sequence
from itertools import combinations
from typing import NamedTuple

from safeloc.models.localizer.simulation.journey import KINDS, OF_THE_ROUTE, UNLAWFUL


class Faulty(NamedTuple):
    """A kind of fault, and the groups of balises that may have it; one has it, that no other fault of the situation has."""

    kind: str
    groups: Sequence[int] = ()


FAULTS = tuple(
    Faulty(kind, (2, 3, 1) if kind.startswith("balise") else ())
    for kind in KINDS.figures
    if kind not in (*UNLAWFUL, *OF_THE_ROUTE)
)
SHARE = 0.001
"""Weight of each situation with a fault."""
HEAD = """machine = "localizer"
cycles = 1_800
seed = 21
shard_vehicles = 100

[figures]
satellites = { distribution = "choice", values = [5, 6, 8, 16], unit = "satellites" }
speed_share = { distribution = "uniform", low = 0.3, high = 1.0, unit = "share" }
acceleration_share = { distribution = "uniform", low = 0.5, high = 1.3, unit = "share" }
stands = { distribution = "uniform", low = 0, high = 30, unit = "s" }

[[lines]]
line = "metro"
weight = 0.4
[[lines]]
line = "main-line"
weight = 0.4
[[lines]]
line = "freight"
weight = 0.2
"""
TIMES = """begin = { distribution = "uniform", low = 5, high = 150, unit = "s" }
lasts = { distribution = "log-uniform", low = 0.3, high = 60, unit = "s" }
"""


def situations() -> list[tuple[Faulty, ...]]:
    """Return no fault, each single one, and each pair."""
    return [(), *((one,) for one in FAULTS), *combinations(FAULTS, 2)]


def declaration(vehicles: int) -> Iterator[str]:
    """Yield the text of the campaign, piece by piece."""
    every = situations()
    yield HEAD
    for faults in every:
        weight = SHARE if faults else 1 - SHARE * (len(every) - 1)
        name = ", ".join(one.kind for one in faults) or "no fault"
        yield f'\n[[situations]]\nname = "{name}"\nweight = {weight:.3f}\nvehicles = {vehicles}\n'
        taken: set[int] = set()
        for one in faults:
            group = next((number for number in one.groups if number not in taken), None)
            taken |= set() if group is None else {group}
            where = "" if group is None else f"where = {group}\n"
            yield f'[[situations.faults]]\nkind = "{one.kind}"\n{where}{TIMES}'


if __name__ == "__main__":
    sys.stdout.writelines(declaration(int(sys.argv[1])))
