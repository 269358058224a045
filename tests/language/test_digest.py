"""A declaration's digest: the same for the same meaning, another one for any other."""

from __future__ import annotations

from dataclasses import replace

import pytest

from safeloc.language.composition import compose
from safeloc.language.digest import declaration_digest, full_digest
from safeloc.language.expr import floor_div, number
from safeloc.language.machine import ANY, Initial, Machine, Transition, modes
from safeloc.language.system import TransitionSystem, lower
from safeloc.language.units import CM, MM, Unit
from safeloc.language.world import World
from tests.examples import EXAMPLES


def gauge(
    *,
    name: str = "gauge",
    unit: Unit = MM,
    high: int = 9,
    first: Initial = 0,
    divisor: int = 2,
    least: int = 5,
    shown: str = "half",
    row: str = "see",
    modes_: tuple[str, ...] = ("ON", "OFF"),
) -> TransitionSystem:
    """A small system, different in one respect."""
    table = modes(*modes_)
    value, seen = number("value", unit, 0, high), number("seen", unit, 0, high)
    rows = [Transition(row, table, table[0], value > least, {seen: value})]
    return lower(Machine(name, table, [value], {seen: first}, {shown: floor_div(seen, divisor)}, rows))


OTHERS = {
    "name": gauge(name="other"),
    "unit": gauge(unit=CM),
    "range": gauge(high=8),
    "first value": gauge(first=1),
    "open first value": gauge(first=ANY),
    "divisor": gauge(divisor=3),
    "constant": gauge(least=6),
    "output's name": gauge(shown="third"),
    "mode's name": gauge(modes_=("ON", "AWAY")),
}


@pytest.mark.parametrize("what", OTHERS)
def test_any_difference_shows(what: str) -> None:
    """Declarations that differ have different digests."""
    assert declaration_digest(gauge()) != declaration_digest(OTHERS[what])


def test_the_same_declaration_again_is_the_same() -> None:
    """The digest does not depend on the place of the declaration and the names of rows; it has 64 hexadecimal digits."""
    assert declaration_digest(gauge()) == declaration_digest(gauge(row="look"))
    assert len(declaration_digest(gauge())) == 64


def test_examples_differ() -> None:
    """No two examples have one digest, nor two moves of one variable."""
    digests = {declaration_digest(example.system) for example in EXAMPLES}
    assert len(EXAMPLES) == len(digests)
    system = gauge()
    still = replace(system, next={var: var for var in system.state})
    assert declaration_digest(system) != declaration_digest(still)


# ------------------------------------------------------------------ all that verdicts depend on


def world(*, assumed: int = 5, lemma: str = "small", ghost: bool = True, row: str = "see") -> Machine:
    """A machine with an environment, different in one respect."""
    table = modes("ON", "OFF")
    value, seen, truth = number("value", MM, 0, 9), number("seen", MM, 0, 9), number("truth", MM, 0, 9)
    rows = [Transition(row, table, table[0], value > 2, {seen: value})]
    state: dict[object, object] = {seen: 0} if ghost else {seen: 0, truth: 0}
    return Machine(
        "world",
        table,
        [value],
        state,  # type: ignore[arg-type] # written shorter than its type
        {},
        rows,
        world=World(
            ghosts={truth: 0} if ghost else {},
            moves={truth: truth} if ghost else {},
            clauses={"assumption": value <= assumed},
        ),
        lemmas={lemma: seen <= 9},
    )


DEEPER = {
    "assumption": world(assumed=6),
    "lemma's name": world(lemma="little"),
    "ghost": world(ghost=False),
    "transition's name": world(row="hear"),
}


@pytest.mark.parametrize("what", DEEPER)
def test_what_a_proof_rests_on_shows_in_the_full_digest(what: str) -> None:
    """Assumption, lemmas, ghosts and names of transitions: each makes another full digest."""
    assert full_digest(lower(world())) != full_digest(lower(DEEPER[what]))
    assert full_digest(lower(world())) == full_digest(lower(world()))


def test_the_assumption_is_not_in_the_digest_of_snapshots() -> None:
    """A snapshot of a machine with another assumption is taken: what it means to run is the same."""
    assert declaration_digest(lower(world())) == declaration_digest(lower(world(assumed=6)))


def test_the_parts_of_a_composition_show() -> None:
    """The full digest of a composition covers the assumptions of its machines on earlier ones."""
    one, other = (compose("whole", [world(assumed=limit)], {}).system for limit in (5, 6))
    same_whole = replace(other, assume=one.assume)
    assert full_digest(one) != full_digest(same_whole)
