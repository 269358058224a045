"""Which mutants there are: of terms by where they are written, and of rows."""

from __future__ import annotations

from collections import Counter
from contextlib import suppress
from itertools import product

import pytest

from safeloc.assurance.mutation.declared import declared
from safeloc.assurance.mutation.kinds import changes
from safeloc.assurance.mutation.mutants import sample
from safeloc.assurance.mutation.places import noted
from safeloc.assurance.mutation.same import Forms, terms_of
from safeloc.errors import InputError
from safeloc.language.expr import (
    Num,
    ceil_div,
    choice,
    enumeration,
    floor_div,
    ite,
    maximum,
    members,
    minimum,
    number,
    optional,
)
from safeloc.language.interpret import evaluate
from safeloc.language.nodes import Add, Bool, BoolVar, Compare, Expr
from safeloc.language.render import infix
from safeloc.language.spec import earlier_bool
from safeloc.language.terms import children
from safeloc.language.units import MM
from tests.assurance.mutation.shop import every, known, loaded, mutant

A, B = number("a", MM, -9, 9), number("b", MM, -9, 9)
P, Q = BoolVar("p"), BoolVar("q")
COLOUR = members("colour", "RED", "GREEN", "BLUE")
LAMP = choice("lamp", enumeration(COLOUR))
READ = optional("read", MM, -9, 9)


def written(term: Expr) -> dict[str, list[str]]:
    """What may be written instead of a term, by kind; `a` may have been meant for `b`, `p` for `q`, and the other way round."""
    twins = {A: B, B: A, P: Q, Q: P}
    told: dict[str, list[str]] = {}
    for one in changes(term, twins.get):
        told.setdefault(one.kind, []).append(infix(one.make(children(term))))
    return told


@pytest.mark.parametrize(
    ("term", "expected"),
    [
        (A < 5, {
            "bound off by one unit": ["a ≤ 5 mm", "(a + 1 mm) < 5 mm"], "comparison turned": ["5 mm < a"],
            "another variable of the same unit": ["b < 5 mm"],
            "figure replaced by its neighbour": ["a < 6 mm"], "figure replaced by zero": ["a < 0 mm"],
        }),
        (A <= B, {
            "bound off by one unit": ["a < b", "a ≤ (b + 1 mm)"], "comparison turned": ["b ≤ a"],
            "another variable of the same unit": ["b ≤ b", "a ≤ a"],
        }),
        (A.eq(0), {
            "bound off by one unit": ["a = (0 mm + 1 mm)"], "comparison turned": ["a ≠ 0 mm"],
            "another variable of the same unit": ["b = 0 mm"], "figure replaced by its neighbour": ["a = 1 mm"],
        }),
        (LAMP.eq(COLOUR[2]), {
            "comparison turned": ["lamp ≠ BLUE"], "figure replaced by its neighbour": ["lamp = RED"],
        }),
        (A - 3, {
            "term of a sum dropped": ["a", "0 mm − 3 mm"], "sign turned": ["a + 3 mm"],
            "another variable of the same unit": ["b − 3 mm"],
            "figure replaced by its neighbour": ["a − 4 mm"], "figure replaced by zero": ["a − 0 mm"],
        }),
        (-A, {"sign turned": ["a"], "another variable of the same unit": ["0 mm − b"]}),
        (maximum(A, B), {
            "min for max": ["min(a, b)"], "another variable of the same unit": ["max(b, b)", "max(a, a)"],
        }),
        (minimum(A, -3), {
            "min for max": ["max(a, -3 mm)"], "another variable of the same unit": ["min(b, -3 mm)"],
            "figure replaced by its neighbour": ["min(a, -4 mm)"], "figure replaced by zero": ["min(a, 0 mm)"],
        }),
        (floor_div(A, 4), {
            "rounding turned": ["0 mm − ⌊(0 mm − a) / 4⌋"], "figure replaced by its neighbour": ["⌊a / 5⌋"],
            "another variable of the same unit": ["⌊b / 4⌋"],
        }),
        (P & (A < B), {
            "and for or": ["p or (a < b)"], "condition dropped": ["a < b", "p"],
            "another variable of the same unit": ["q and (a < b)"],
        }),
        (P | READ.present, {
            "and for or": ["p and read.present"], "condition dropped": ["read.present", "p"],
            "another variable of the same unit": ["q or read.present"], "absence ignored": ["true"],
        }),
        (~P, {"condition turned": ["p"], "another variable of the same unit": ["not q"]}),
        (~(A < B), {}),
        (ite(P, A, 2), {
            "condition dropped": ["a", "2 mm"], "condition turned": ["2 mm if p else a"],
            "another variable of the same unit": ["a if q else 2 mm", "b if p else 2 mm"],
            "figure replaced by its neighbour": ["a if p else 3 mm"], "figure replaced by zero": ["a if p else 0 mm"],
        }),
    ],
    ids=lambda part: infix(part) if isinstance(part, Expr) else "",
)  # fmt: skip
def test_what_is_written_instead(term: Expr, expected: dict[str, list[str]]) -> None:
    """Each kind of wrong term, and none twice."""
    assert expected == written(term)


@pytest.mark.parametrize("term", [A < B, A <= B, A > B, A >= B], ids=infix)
def test_a_bound_moves_both_ways(term: Bool) -> None:
    """By one unit each: what makes a claim weaker makes its negation stronger."""
    left, right = (side for side in children(term) if isinstance(side, Num))
    expected = [left < right + 1, left + 1 < right] if _is_strict(term) else [left <= right - 1, left <= right + 1]
    moved = [one.make(children(term)) for one in changes(term, lambda _: None) if one.kind == "bound off by one unit"]
    assert list(map(_where_true, expected)) == list(map(_where_true, moved))


def _is_strict(term: Bool) -> bool:
    return isinstance(term, Compare) and term.op == "<"


def _where_true(term: Expr) -> list[tuple[int, int]]:
    pairs = product(range(-3, 4), repeat=2)
    return [(a, b) for a, b in pairs if evaluate([term], {A: a, B: b}) == [True]]


def test_a_quotient_rounded_up_is_rounded_down() -> None:
    """`ceil_div` is made of a quotient that is rounded down, and turns like it."""
    up = ceil_div(A, 4)
    assert ["0 mm − ⌊(0 mm − (0 mm − a)) / 4⌋"] == written(children(up)[1])["rounding turned"]


def test_another_unit_is_no_sum() -> None:
    """What only tells a unit has no terms to be dropped."""
    relabelled = Add(A, number("z", MM, 0, 0) * 0, MM)
    assert "term of a sum dropped" in written(relabelled)


def test_terms_know_their_source() -> None:
    """A term is told with the expression that wrote it, in its file."""
    one = mutant("bound off by one unit", "< becomes <=", "'brakes'")
    assert "self.speed > LIMIT_MM_S" == one.source
    file, _, line = one.place.rpartition(":")
    assert file.endswith("brake.py") and int(line) > 0


def test_a_claim_has_the_guards_term() -> None:
    """A term that claim and guard get from one function is one term; a claim's own figure is none of the machine's."""
    one = mutant("bound off by one unit", "< becomes <=", "'brakes'")
    assert ("claim brakes when too fast",) == one.shared_with
    assert one.everywhere is not None
    assert not [other for other in every() if "60 mm/s" in other.term]


def test_looking_back_is_the_same_term() -> None:
    """What a claim says of the step before is written where the machine's term is."""
    one = mutant("bound off by one unit", "one unit more")
    assert ("claim worn brakes stay on",) == one.shared_with
    made = one.everywhere
    assert made is not None
    before, after = (
        next(prop.term for prop in whole.properties if prop.name == "worn brakes stay on")
        for whole in (loaded()[1], made(loaded()[1]))
    )
    assert "3 count ≤ before.brakings" in infix(before)
    assert "3 count ≤ (before.brakings + 1 count)" in infix(after)


def test_the_machine_alone() -> None:
    """With the machine alone wrong the claims stay as they are."""
    one = mutant("bound off by one unit", "< becomes <=", "'brakes'")
    _, whole, _ = loaded()
    alone, everywhere = one.alone(whole), one.everywhere
    assert everywhere is not None
    told = [infix(made.machine.transitions[0].when) for made in (whole, alone, everywhere(whole))]
    assert ["50 mm/s < speed_mm_s", "50 mm/s ≤ speed_mm_s", "50 mm/s ≤ speed_mm_s"] == told
    assert whole.properties[0].term is alone.properties[0].term
    assert infix(whole.properties[0].term) != infix(everywhere(whole).properties[0].term)


def test_terms_at_other_places_are_others() -> None:
    """Two terms of one form that are written at two places are two terms."""
    with noted() as places:
        first = A < 5
        second = A < 5
        third = earlier_bool(first)
    assert places.of(first) != places.of(second)
    assert places.of(first) == places.of(third)
    assert places.of(A < 7) is None
    forms = Forms(places)
    assert forms.of(first) == forms.of(second) == forms.of(third)


def test_nothing_is_noted_afterwards() -> None:
    """Making terms is as before once the noting is over, also where it ended with an error."""
    plain = Add.__init__
    with suppress(ZeroDivisionError), noted():
        assert Add.__init__ is not plain
        _ = 1 // 0
    assert Add.__init__ is plain


def test_rows() -> None:
    """Updates are skipped, targets changed, guards always or never met."""
    told = Counter((one.kind, one.words) for one in every() if one.where == ("row 'brakes'",))
    assert 1 == told["update skipped", "brakings keeps its value"]
    assert 1 == told["target changed", "to RUN instead of BRAKE"]
    assert {"always enabled", "never enabled"} <= {words for kind, words in told if kind == "condition dropped"}
    assert 1 == told["another variable of the same unit", "brakings becomes spare"]


def test_ids_are_of_content() -> None:
    """Each mutant has an id of its own, and the same one when the machine is loaded again."""
    ids = [one.id for one in every()]
    assert len(set(ids)) == len(ids)
    loaded.cache_clear()
    every.cache_clear()
    known.cache_clear()  # of the declaration before
    assert ids == [one.id for one in every()]


def test_requirements_of_rows() -> None:
    """A mutant names the requirements that its rows answer for."""
    assert ("REQ-1",) == mutant("update skipped", "brakings keeps its value").requirements


def test_a_sample_has_every_kind() -> None:
    """Each kind is there, in about its share; the same seed draws the same."""
    kinds = {one.kind for one in every()}
    few = sample(every(), len(kinds), 3)
    assert kinds == {one.kind for one in few}
    assert few == sample(every(), len(kinds), 3)
    assert [*every()] == sample(every(), 10_000, 0)


def test_terms_below_all_roots() -> None:
    """A term stands below a guard, an update or an output, or beyond; never nowhere."""
    _, whole, places = loaded()
    for term in terms_of(whole.roots, places, Forms(places)):
        assert term.on_board or term.beyond
        assert isinstance(term.node, (Num, Bool))


def test_a_composition_is_refused() -> None:
    """For now: the message names the machines to give instead."""
    with pytest.raises(InputError, match="supervised_odometry is a composition of odometry, delocalized"):
        declared("supervised_odometry")
