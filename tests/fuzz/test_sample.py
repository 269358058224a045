"""A sample of the fuzzer, with fixed seeds: no verdict, fact or obligation disagrees, and no back end diverges.

The long run is `make test-long TOPIC=fuzz`. What it samples is counted, so that it cannot come to sample nothing.
"""

from __future__ import annotations

from collections.abc import Iterable
from random import Random

import pytest

from safeloc.proof.provers.limits import Limits
from tests.fuzz.cases import KINDS, Plan
from tests.fuzz.draw import Draw
from tests.fuzz.draw_whole import whole
from tests.fuzz.expect import NOW, OPEN
from tests.fuzz.tally import TRAPS, Tally, total
from tests.fuzz.terms import below

LIGHT = Plan(
    TRAPS - OPEN,
    NOW,
    claims=1,
    engines=("k-induction", "bmc"),
    rarely=("portfolio", "Spacer"),
    every=12,
    light=True,
    limits=Limits(depth=8, induction=2, seconds=1.0),
    compile_every=12,
)
SEED = 1
BLOCKS = 5


def sampled(kind: str, numbers: Iterable[int]) -> Tally:
    """All cases together; every complaint with the number of its case."""
    all_ = Tally()
    for number in numbers:
        one = KINDS[kind](SEED, number, LIGHT)
        one.wrong = [f"{kind} {number}: {complaint}" for complaint in one.wrong]
        all_.add(one)
    return all_


@pytest.mark.thorough(ordinary=1)
@pytest.mark.parametrize("block", range(BLOCKS))
def test_machines_agree(block: int) -> None:
    """Forty machines: a claim by induction with the base, or by bounded search; now and then all engines and obligations."""
    found = sampled("machine", range(40 * block, 40 * (block + 1)))
    assert [] == found.wrong
    assert found.compared["bmc"] >= 10
    assert found.compared["obligation reachable"] >= 3


@pytest.mark.thorough(ordinary=1)
@pytest.mark.parametrize("block", range(3))
def test_compositions_agree(block: int) -> None:
    """Eight compositions: contracts, what is inherited, and the rest."""
    found = sampled("composition", range(8 * block, 8 * (block + 1)))
    assert [] == found.wrong
    assert found.compared["inherited"] >= 4


@pytest.mark.thorough(ordinary=1)
@pytest.mark.parametrize("block", range(2))
def test_back_ends_agree(block: int) -> None:
    """Twenty-five machines and compositions up to the ends of 64 bits, two of them in C, by every back end."""
    found = sampled("back ends", range(25 * block, 25 * (block + 1)))
    assert [] == found.wrong
    assert {"interpreter", "Python", "transitions", "numpy", "C", "lanes", "solvers"} <= set(found.compared)


def test_the_same_number_is_the_same_case() -> None:
    """A case is made again from its seed and number: what was found once can be looked at."""
    assert total([sampled("machine", [3])]).compared == sampled("machine", [3]).compared


def test_machines_are_drawn_that_hear_later_ones() -> None:
    """Of sixty compositions several have a wire that tells the state of a later machine before the step."""
    drawn = [whole(Draw(Random(f"late {number}"))) for number in range(60)]
    late = [name for made in drawn for name, term in made.wires.items() if any(one[0] == "was" for one in below(term))]
    assert len(late) >= 6
    assert sum(name.startswith("A.") for name in late) >= 3
