"""The tube itself: a machine that writes down its inputs comes to exactly the states of the streams that lie in the tube."""

from __future__ import annotations

from itertools import product

from hypothesis import HealthCheck, given, settings
from hypothesis import strategies as st

from safeloc.codegen.simplify_under_facts import Known
from safeloc.language.expr import TRUE, Num, NumVar, boolean, ite, number, optional
from safeloc.language.interpret import evaluate, read_inputs, start, step
from safeloc.language.machine import Machine, Transition, modes
from safeloc.language.spec import always, observe
from safeloc.language.system import lower, without_ghosts
from safeloc.language.units import ONE
from safeloc.proof.around.containment import Row, first_outside
from safeloc.proof.around.course import Piece, Space
from safeloc.proof.around.deviations import Channel, Deviations
from safeloc.proof.around.hand_over import joined
from safeloc.proof.around.intervals import Intervals
from safeloc.proof.around.tube import Given, Tube
from safeloc.proof.around.windows import Breaks, Claim, Holds, Windows
from safeloc.proof.provers.limits import Limits
from tests.random_machines import machines

BASE = 16
ALWAYS, MAYBE = number("always", ONE, 0, 2), optional("maybe", ONE, 0, 1)
CODE = number("code", ONE, 0, BASE**3 - 1)
(ON,) = TABLE = modes("ON")


def writer() -> Machine:
    """Three cycles are written into one number, digit by digit."""
    digit = ALWAYS * 4 + ite(MAYBE.present, MAYBE.value + 1, 0)
    rows = [Transition("write", ON, ON, TRUE, {CODE: ite(CODE * BASE + digit <= CODE.high, CODE * BASE + digit, 0)})]
    return Machine("writer", TABLE, [ALWAYS, MAYBE], {CODE: 0}, {"code": CODE}, rows)


SYSTEM = without_ghosts(lower(writer()))
RECORDS = [{"always": n, **({} if m is None else {"maybe": m})} for n in range(3) for m in (None, 0, 1)]
EVERY = [read_inputs(SYSTEM, record) for record in RECORDS]


def last_code(rows: list[Row]) -> int:
    """The number after these cycles."""
    state = start(SYSTEM)
    for row in rows:
        state, _ = step(SYSTEM, state, row)
    return int(state[CODE])


@given(
    rows=st.lists(st.sampled_from(EVERY), min_size=3, max_size=3),
    widths=st.fixed_dictionaries({}, optional={"always": st.integers(1, 2), "maybe": st.just(1)}),
    drops=st.integers(0, 2),
    delay=st.integers(0, 2),
    late=st.integers(0, 2),
    window=st.sampled_from((1, 3)),
    data=st.data(),
)
@settings(
    max_examples=settings.default.max_examples // 12,
    deadline=None,
    suppress_health_check=[HealthCheck.too_slow, HealthCheck.filter_too_much, HealthCheck.data_too_large],
)
def test_exactly_the_streams_of_the_tube_are_run(
    rows: list[Row], widths: dict[str, int], drops: int, delay: int, late: int, window: int, data: st.DataObject
) -> None:
    """A final number is excluded exactly if it is that of no stream which lies in the tube by the check on values."""
    channels = tuple(
        one for one in (Channel(("maybe",), drops, delay), Channel(("always",), 0, late)) if one.drops or one.delay
    )
    tube = Tube(SYSTEM, Given(rows, start(SYSTEM)), Deviations(widths, channels))
    inside, outside = set[int](), set[int]()
    for some in product(EVERY, repeat=3):
        (inside if first_outside(tube, some) is None else outside).add(last_code(list(some)))
    assert last_code(rows) in inside
    near = sorted(outside, key=lambda code: min(abs(code - one) for one in inside))[:40]
    for code in [
        data.draw(st.sampled_from(sorted(inside))),
        *(data.draw(st.sampled_from(near)) for _ in range(3 if near else 0)),
    ]:
        goal = observe(SYSTEM, always("not this", CODE.ne(code)))
        [found] = (
            Windows(Space(goal.system, tube), [Claim("not this", goal, 3, 3)], Limits(), window=window)
            .outcomes()
            .values()
        )
        assert isinstance(found, Breaks if code in inside else Holds), (code, found)
        if isinstance(found, Breaks):
            assert (first_outside(tube, found.stream), last_code(list(found.stream))) == (None, code)


@given(st.data())
@settings(
    max_examples=60,
    deadline=None,
    suppress_health_check=[HealthCheck.too_slow, HealthCheck.filter_too_much, HealthCheck.data_too_large],
)
def test_folding_with_bounds_changes_no_value(data: st.DataObject) -> None:
    """Terms of random machines, folded with variables in narrow ranges, have the values that they had; bounds hold them."""
    system = lower(data.draw(machines()))
    narrow = {}
    for var in (*system.state, *system.inputs):
        if isinstance(var, NumVar):
            low = data.draw(st.integers(var.low, var.high))
            high = data.draw(st.integers(low, min(var.high, low + 3)))
            narrow[var] = NumVar(f"{var.name} here", var.unit, low, high)
    bounds = Intervals()
    terms = [*system.next.values(), *system.outputs.values()]
    known = Known(narrow, bounds.decide)
    folded = [known(term) for term in terms]
    for _ in range(5):
        values = {}
        for var in (*system.state, *system.inputs):
            near = narrow.get(var) if isinstance(var, NumVar) else None
            values[var] = data.draw(st.booleans()) if near is None else data.draw(st.integers(near.low, near.high))
        mine = {**{narrow[var]: value for var, value in values.items() if var in narrow}, **values}
        right, found = evaluate(terms, values), evaluate(folded, mine)
        assert [int(one) for one in found] == [int(one) for one in right]
        for term, value in zip(folded, found, strict=True):
            if isinstance(term, Num):
                low, high = bounds(term)
                assert low <= value <= high


def test_comparisons_are_decided_at_their_ends_only() -> None:
    """A comparison that some values keep and some break is left open."""
    x, y = NumVar("x", ONE, 0, 5), NumVar("y", ONE, 5, 9)
    bounds = Intervals()
    assert (bounds.decide("<", x, y), bounds.decide("<=", x, y), bounds.decide("==", x, y)) == (None, True, None)
    assert (bounds.decide("<", y, x), bounds.decide("<=", y, x)) == (False, None)
    assert (bounds.decide("<", x, x + 1), bounds.decide("==", x - y + 1, x - y)) == (True, False)


def test_joined_pieces_hold_what_either_holds() -> None:
    """Ranges and constants of pieces with the same labels become ranges of both; other labels stay apart."""
    a, b, flag = NumVar("a", ONE, 0, 9), NumVar("b", ONE, 0, 9), boolean("flag")
    one = Piece({a: 3, flag: True}, {b: (2, 4)})
    two = Piece({a: 5, flag: True, b: 7})
    three = Piece({a: 5, flag: False, b: 7})
    both, other = joined([one, two, three], [flag])
    assert (dict(both.fixed), dict(both.ranges)) == ({flag: True}, {a: (3, 5), b: (2, 7)})
    assert other is three
