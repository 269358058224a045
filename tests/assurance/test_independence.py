"""What claims and clauses share with the rows of their machine is found by structure, and nothing else is."""

from __future__ import annotations

from dataclasses import replace

import pytest

from safeloc.assurance.independence import Shared, by_term, follows_machine, shared_terms
from safeloc.catalogue import configured
from safeloc.errors import ModelError
from safeloc.language.composition import compose
from safeloc.language.expr import (
    Bool,
    NumVar,
    before,
    boolean,
    choice,
    enumeration,
    ite,
    members,
    minimum,
    number,
)
from safeloc.language.machine import ANY, Machine, Transition, modes
from safeloc.language.spec import Property, always
from safeloc.language.system import lower
from safeloc.language.units import MM
from safeloc.language.world import Law, World
from safeloc.shipped_machines import ENTRIES
from safeloc.target import Target

ON, OFF = modes("ON", "OFF")
X, Y, GO = number("x", MM, 0, 100), number("y", MM, 0, 100), boolean("go")
N, TRUTH, NEXT = number("n", MM, 0, 500), number("truth", MM, 0, 100), number("next", MM, 0, 100)


def far() -> Bool:
    """The machine's guard, eleven nodes, made anew at each call."""
    return (X + Y * 2 > N) & (Y + 3 > X)


def machine(law: Bool | Law = TRUTH < 50, **world: str) -> Machine:
    """Sets n where the guard holds."""
    around = World({TRUTH: ANY}, [NEXT], {TRUTH: NEXT}, {"the law": law}, **world)
    row = Transition("far", ON, OFF, far(), {N: X + Y})
    return Machine("m", (ON, OFF), [X, Y, GO], {N: 0}, {"sum": N * 2 + N * 3 + 7}, [row], world=around)


def target(*claims: Property, law: Bool | Law = TRUTH < 50) -> Target:
    """A target with these claims."""
    made = machine(law)
    return Target("m", (made,), lower(made), claims)


def found(*claims: Property, law: Bool | Law = TRUTH < 50) -> list[Shared]:
    """What they share."""
    return shared_terms(target(*claims, law=law))


def test_a_claim_of_the_machine_s_own_guard_is_told_with_its_place() -> None:
    """Written a second time it is the same formula; where it is used and who says it are told."""
    (one,) = found(always("own term", far().implies(GO)))
    assert ("property own term", 11) == (one.of, one.nodes)
    assert {"next value of mode", "next value of n", "transition that fires"} == set(one.used)
    assert "test_independence.py:" in one.src


def far_on(kept: NumVar) -> Bool:
    """A formula of nine nodes over one machine's state."""
    return kept * 2 + kept * 3 + 7 < 90


def test_what_a_late_wire_tells_is_in_the_claim_that_reads_it() -> None:
    """The wire's term stands in a row as well; what one machine computes is still found."""
    made, heard, kept = machine(), boolean("heard"), number("kept", MM, 0, 500)
    row = Transition("heard", ON, OFF, heard & far_on(kept), {kept: 7})
    early = Machine("early", (ON, OFF), [heard], {kept: 0}, {"kept": kept}, [row])
    whole = compose("w", [early, made], {heard: (before(N) > before(kept) + 3) & (before(N) < 90)})
    into = whole.of(early)
    claims = (
        always("wire", into.bool(heard)),
        always("row", into.bool(far_on(kept)).implies(into.bool(heard))),
    )
    told = shared_terms(Target("w", (early, made), whole.system, claims))
    assert {"property row"} == {one.of for one in told}
    assert all("kept" in one.term and "m.n" not in one.term for one in told)


def test_shared_terms_are_grouped() -> None:
    """By term, the largest first; those of one term stay in their order."""
    few, many = (Shared(of, nodes, f"term of {nodes}", (), "") for of, nodes in (("a", 6), ("b", 9)))
    again = replace(few, of="c")
    assert [[many], [few, again]] == by_term([few, many, again])


def test_a_value_before_the_step_is_the_same_variable() -> None:
    """A claim speaks of the step that was; the row of the one to come."""
    ahead = (X + Y * 2 > before(N)) & (Y + 3 > X)
    assert [11] == [one.nodes for one in found(always("a step later", ahead.implies(GO)))]


def test_small_terms_and_outputs_are_not_told() -> None:
    """A sum of two inputs is no formula, and a claim may speak of what is put out, as a whole."""
    made = target()
    small = always("small", (X + Y > 3).implies(GO))
    output = always("of an output", made.machines[0].output("sum") > 2)
    assert [] == found(small)
    assert [] == shared_terms(replace(made, properties=(output,)))


COLOURS = members("colour", "RED", "AMBER", "GREEN", "DARK")
COLOUR, OTHER = choice("colour", enumeration(COLOURS)), choice("other", enumeration(COLOURS))
LIT = COLOUR.one_of(*COLOURS[:3])


def of_colours(guard: Bool) -> list[Shared]:
    """What a claim shares with a machine that both ask the same of colours and of a sum."""
    row = Transition("far", ON, OFF, guard)
    made = Machine("m", (ON, OFF), [X, Y, GO, COLOUR, OTHER], {N: 0}, {}, [row])
    return shared_terms(Target("m", (made,), lower(made), (always("of colours", guard.implies(GO)),)))


@pytest.mark.parametrize("guard", [LIT, ~LIT, COLOUR.one_of(*COLOURS[1:])])
def test_named_values_of_one_variable_are_not_told(guard: Bool) -> None:
    """Three colours by name are words of the declaration; no wrong edit of a formula is hidden by saying the same words."""
    assert [] == of_colours(guard)


@pytest.mark.parametrize(
    ("guard", "nodes"),
    [
        (LIT & GO, 10),
        (COLOUR.one_of(*COLOURS[:2]) | OTHER.eq(COLOURS[0]), 9),
        (COLOUR.eq(OTHER) | COLOUR.one_of(*COLOURS[:2]), 9),
        ((X > 3) & (X < 50), 6),
        (X.one_of(3, 4, 5), 8),
    ],
)
def test_conditions_of_two_variables_and_figures_are_told(guard: Bool, nodes: int) -> None:
    """What is put together of two variables is a judgement, and figures are chosen: both can be wrong."""
    assert [nodes] == [one.nodes for one in of_colours(guard)]


def test_a_clause_that_repeats_a_guard_is_told() -> None:
    """It reads inputs only and is lawful, but it moves with the machine."""
    guard = (Y + 3 > X) & (X + Y * 2 > Y)
    around = World({TRUTH: ANY}, [NEXT], {TRUTH: NEXT}, {"the law": (Y + 3 > X) & (X + Y * 2 > Y)})
    made = Machine("m", (ON, OFF), [X, Y], {N: 0}, {}, [Transition("far", ON, OFF, guard)], world=around)
    (one,) = shared_terms(Target("m", (made,), lower(made), ()))
    assert ("clause the law of m", "") == (one.of, one.reason)


def test_a_law_says_why_it_shares() -> None:
    """The reason stands in the law, and comes with each part that it has in common with the machine."""
    law = Law((Y + 3 > X) & (X + Y * 2 > Y), shares="both are one input's meaning")
    around = World({TRUTH: ANY}, [NEXT], {TRUTH: NEXT}, {"the law": law})
    made = Machine("m", (ON, OFF), [X, Y], {N: 0}, {}, [Transition("far", ON, OFF, law.term)], world=around)
    assert ["both are one input's meaning"] == [
        one.reason for one in shared_terms(Target("m", (made,), lower(made), ()))
    ]


def test_what_an_output_may_be_is_put_out() -> None:
    """A wire passes on the value of an output without the condition under which there is one."""
    made = machine()
    chosen = replace(made, outputs={"sum": ite(N > 3, N * 2 + N * 3 + 7, 0)})
    claim = always("of the sum", N * 2 + N * 3 + 7 < 900)
    assert [] == shared_terms(Target("m", (chosen,), lower(chosen), (claim,)))


def test_an_output_within_a_term_is_one_node() -> None:
    """A wire that keeps an output in range is as small as one over a variable; beside another formula it is told."""
    made = machine()
    clamped = minimum(N * 2 + N * 3 + 7, 90) < 80
    row = Transition("far", ON, OFF, clamped & (X + Y * 2 > N), {N: X + Y})
    kept = replace(made, transitions=[row])
    claims = always("clamped", clamped), always("more", (clamped & (X + Y * 2 > N)).implies(GO))
    assert ["property more"] == [one.of for one in shared_terms(Target("m", (kept,), lower(kept), claims))]


@pytest.mark.thorough(ordinary=3)
@pytest.mark.parametrize("name", ENTRIES)
def test_a_shipped_machine_shares_nothing_without_a_reason(name: str) -> None:
    """In each configuration each part that a law has in common with its machine has a written reason; claims have none in common."""
    for _, target in configured(name, ["all"]):
        shared = shared_terms(target)
        assert [] == [(one.of, one.term) for one in shared if not one.reason]
        assert [] == [one.of for one in shared if one.of.startswith("property")]


def test_a_law_that_reads_state_is_refused_without_a_reason() -> None:
    """The message names the law and what it reads; with a reason it is accepted, and listed."""
    with pytest.raises(ModelError, match=r"clause 'the law' reads 'n', which the machine computes; let it read inputs"):
        machine(N < 50)
    made = machine(Law(N < 50, "n stays low"), reads_machine="for the test")
    (one,) = follows_machine(Target("m", (made,), lower(made), ()))
    assert ("clause 'the law' of m", ("n",), "for the test") == (one.of, one.reads, one.reason)


def test_a_move_that_reads_state_is_refused() -> None:
    """The truth does not follow the machine."""
    made = machine()
    with pytest.raises(ModelError, match=r"move of ghost 'truth' reads 'n', which the machine computes"):
        replace(made, world=replace(made.world, moves={TRUTH: N}))


def test_a_figure_of_the_site_may_be_read() -> None:
    """A state variable that no row sets, such as the place of a counter, follows no edit; one that a row sets is refused."""
    place = number("place", MM, 0, 500)
    made = machine()
    state, world = {**made.state, place: ANY}, World({TRUTH: ANY}, [NEXT], {TRUTH: NEXT}, {"the law": TRUTH < place})
    fixed = replace(made, state=state, world=world)
    assert [] == follows_machine(Target("m", (fixed,), lower(fixed), ()))
    rows = [replace(row, set={**row.set, place: X + Y}) for row in fixed.transitions]
    with pytest.raises(ModelError, match=r"clause 'the law' reads 'place', which the machine computes"):
        replace(fixed, transitions=rows)
