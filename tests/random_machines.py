"""Hypothesis strategies: well-formed machines of every node kind, and streams biased to the ends of ranges.

Updates are clamped to the range of their variable and products are kept small, so that every machine also fits
64 bits. All plain numbers have one unit; units are not what these machines test.
"""

from __future__ import annotations

from collections.abc import Callable, Mapping
from dataclasses import dataclass, field

from hypothesis import assume
from hypothesis import strategies as st

from safeloc.language.expr import (
    FALSE,
    TRUE,
    Bool,
    BoolVar,
    Expr,
    Lit,
    Num,
    NumVar,
    Optional,
    Var,
    abs_,
    boolean,
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
    product,
)
from safeloc.language.interpret import holds
from safeloc.language.machine import ANY, Initial, Machine, Transition, modes
from safeloc.language.nodes import Value
from safeloc.language.ranges import bounds
from safeloc.language.system import TransitionSystem, canonical
from safeloc.language.units import ONE, Enumeration
from safeloc.language.world import World

LARGEST = 10**9
COLOURS = members("colour", "RED", "GREEN", "BLUE")
RANGES = ((0, 1), (-1, 1), (0, 10), (-7, 13), (5, 9), (-12, -3), (-1000, 1000), (-(10**6), 10**6))

Draw = st.DrawFn
Record = dict[str, Value]


@dataclass
class Pool:
    """Terms made so far, to make further ones of: this is how sub-terms come to be shared."""

    draw: Draw
    nums: list[Num]
    bools: list[Bool]
    colours: list[Num] = field(default_factory=lambda: list(COLOURS))

    def num(self) -> Num:
        """One of the numbers, late ones as likely as early ones."""
        return self.draw(st.sampled_from(self.nums))

    def bool(self) -> Bool:
        """One of the truth values."""
        return self.draw(st.sampled_from(self.bools))

    def colour(self) -> Num:
        """One of the enumerated terms."""
        return self.draw(st.sampled_from(self.colours))

    def grow(self, most: int) -> None:
        """Add up to `most` terms, each made of earlier ones."""
        for _ in range(self.draw(st.integers(0, most))):
            term = self.draw(st.sampled_from(MAKERS))(self)
            if isinstance(term, Bool):
                self.bools.append(term)
            elif isinstance(term.unit, Enumeration):
                self.colours.append(term)
            else:
                self.nums.append(_small(term))


def _small(term: Num) -> Num:
    low, high = bounds([term])[term]
    return term if low >= -LARGEST and high <= LARGEST else maximum(minimum(term, LARGEST), -LARGEST)


def _less(pool: Pool, compare: Callable[[Num, Num], Bool]) -> Bool:
    """A comparison that can change: one that the ranges decide is refused in a guard."""
    left, right = pool.num(), pool.num()
    return pool.bool() if _decided(left, right) else compare(left, right)


def _decided(left: Num, right: Num) -> bool:
    of = bounds([left, right])
    return of[left][1] <= of[right][0] or of[left][0] >= of[right][1]


MAKERS: tuple[Callable[[Pool], Expr], ...] = (
    lambda pool: pool.num() + pool.num(),
    lambda pool: pool.num() - pool.num(),
    lambda pool: pool.num() * pool.draw(st.integers(-5, 5)),
    lambda pool: product(pool.num(), pool.num()),
    lambda pool: floor_div(pool.num(), pool.draw(st.integers(1, 9))),
    lambda pool: ceil_div(pool.num(), pool.draw(st.integers(1, 9))),
    lambda pool: minimum(pool.num(), pool.num()),
    lambda pool: maximum(pool.num(), pool.num()),
    lambda pool: abs_(pool.num()),
    lambda pool: ite(pool.bool(), pool.num(), pool.num()),
    lambda pool: ite(pool.bool(), pool.bool(), pool.bool()),
    lambda pool: ite(pool.bool(), pool.colour(), pool.colour()),
    lambda pool: pool.colour().eq(pool.colour()),
    lambda pool: _less(pool, lambda left, right: left < right),
    lambda pool: _less(pool, lambda left, right: left >= right),
    lambda pool: _less(pool, lambda left, right: left.eq(right)),
    lambda pool: ~pool.bool(),
    lambda pool: pool.bool() & pool.bool(),
    lambda pool: pool.bool() | pool.bool() | pool.bool(),
    lambda pool: pool.bool().iff(pool.bool()),
)


@st.composite
def machines(draw: Draw, *, most_terms: int = 25) -> Machine:
    """A well-formed machine of up to four modes, six transitions and a ghost."""
    table = modes(*("ABCD"[: draw(st.integers(1, 4))]))
    state, inputs = draw(_variables("s")), draw(_variables("i"))
    options = [optional(f"o{n}", ONE, *draw(st.sampled_from(RANGES))) for n in range(draw(st.integers(0, 2)))]
    known: list[Var] = [*state, *inputs, *(var for option in options for var in (option.value, option.present))]
    pool, reports = _pool(draw, known), _pool(draw, state)
    pool.grow(most_terms)
    reports.grow(5)
    ghost, push = number("truth", ONE, -(10**6), 10**6), number("push", ONE, -9, 9)
    return Machine(
        name="random",
        modes=table,
        inputs=[*inputs, *options],
        state={var: draw(_first(var)) for var in state},
        outputs={"number": reports.nums[-1], "flag": reports.bools[-1], "colour": reports.colours[-1]},
        transitions=[
            Transition(
                f"t{row}",
                tuple(draw(st.lists(st.sampled_from(table), min_size=1, unique=True))),
                draw(st.sampled_from(table)),
                pool.bool(),
                {var: _update(pool, var) for var in state if draw(st.booleans())},
                rank=row,
            )
            for row in range(draw(st.integers(0, 6)))
        ],
        world=World(ghosts={ghost: 0}, choices=[push], moves={ghost: _clamped(ghost, ghost + push)}),
    )


def _pool(draw: Draw, known: list[Var]) -> Pool:
    nums: list[Num] = [Lit(value, ONE) for value in (0, 1, -3, 100)]
    pool = Pool(draw, nums, [TRUE, FALSE])
    for var in known:
        if isinstance(var, BoolVar):
            pool.bools.append(var)
        else:
            (pool.colours if isinstance(var.unit, Enumeration) else pool.nums).append(var)
    return pool


@st.composite
def _variables(draw: Draw, prefix: str) -> list[Var]:
    found: list[Var] = []
    for position in range(draw(st.integers(0, 4))):
        name, kind = f"{prefix}{position}", draw(st.sampled_from(("number", "number", "boolean", "colour")))
        if kind == "number":
            found.append(number(name, ONE, *draw(st.sampled_from(RANGES))))
        else:
            found.append(boolean(name) if kind == "boolean" else choice(name, enumeration(COLOURS)))
    return found


def _update(pool: Pool, var: Var) -> Expr:
    if isinstance(var, BoolVar):
        return pool.bool()
    return pool.colour() if isinstance(var.unit, Enumeration) else _clamped(var, pool.num())


def _clamped(var: NumVar, term: Num) -> Num:
    return maximum(minimum(term, var.high), var.low)


@st.composite
def _first(draw: Draw, var: Var) -> Initial:
    return draw(st.one_of(st.just(ANY), values(var)))


# ------------------------------------------------------------------ streams


def values(var: Var) -> st.SearchStrategy[Value]:
    """A value of a variable: an end of its range, next to one, near zero, or any."""
    if isinstance(var, BoolVar):
        return st.booleans()
    low, high = var.low, var.high
    ends = sorted({low, min(low + 1, high), canonical(var), max(high - 1, low), high})
    return st.one_of(st.sampled_from(ends), st.integers(low, high))


def records(system: TransitionSystem) -> st.SearchStrategy[Record]:
    """The inputs of one step by name; optional ones are sometimes absent. The assumption is not obeyed."""
    hidden = {var for option in system.optionals for var in _both(option)}
    needed = {var.name: values(var) for var in system.inputs if var not in hidden}
    return st.fixed_dictionaries(needed, optional={opt.value.name: values(opt.value) for opt in system.optionals})


def _both(option: Optional) -> tuple[Var, Var]:
    return option.value, option.present


def streams(system: TransitionSystem, max_steps: int = 8) -> st.SearchStrategy[list[Record]]:
    """Inputs of zero to `max_steps` steps."""
    return st.lists(records(system), max_size=max_steps)


@st.composite
def first_states(draw: Draw, system: TransitionSystem) -> Record:
    """Values for the variables declared ANY, such that `initially` holds."""
    chosen = {var.name: draw(values(var)) for var in system.state if system.initial[var] is ANY}
    assume(holds(system.init, _full(system, chosen)))
    return chosen


def _full(system: TransitionSystem, chosen: Mapping[str, Value]) -> dict[Var, Value]:
    first: dict[Var, Value] = {}
    for var in system.state:
        declared = system.initial[var]
        first[var] = declared.value if isinstance(declared, Lit) else declared if isinstance(declared, int) else 0
        first[var] = chosen.get(var.name, first[var])
    return first
