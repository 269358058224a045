"""Rules for properties: by themselves, on a system, and several of them observed together."""

from __future__ import annotations

from collections.abc import Iterator, Sequence
from dataclasses import dataclass
from typing import TYPE_CHECKING

from safeloc.errors import PropertyError
from safeloc.language.checks.rule import Rule, complaints
from safeloc.language.checks.terms import malformed
from safeloc.language.expr import Bool, NumVar, Var
from safeloc.language.nodes import INT64_MAX, Past
from safeloc.language.terms import in_order, variables

if TYPE_CHECKING:
    from safeloc.language.spec import Goal, Property
    from safeloc.language.system import TransitionSystem

_LONGEST_NAME = 120
_KINDS = ("always", "within", "reachable")


def check_property(prop: Property) -> None:
    """Raise PropertyError if the declaration by itself is wrong."""
    _refuse(prop, complaints(PROPERTY, prop))


def check_reading(reading: Reading) -> None:
    """Raise PropertyError if a property reads variables that the system does not have, or that it must not read."""
    _refuse(reading.prop, complaints(READING, reading))


def check_watching(goals: Sequence[Goal]) -> None:
    """Raise PropertyError if the observers of several goals cannot be combined in one system."""
    found = complaints(WATCHING, goals)
    if found:
        raise PropertyError(" ".join(found))


def _refuse(prop: Property, found: Sequence[str]) -> None:
    if found:
        raise PropertyError(f"{prop.src}: property {prop.name!r}: {' '.join(found)}")


# ------------------------------------------------------------------ by itself


def _name_can_be_written(prop: Property) -> Iterator[str]:
    if (
        not isinstance(prop.name, str)
        or not prop.name.strip()
        or len(prop.name) > _LONGEST_NAME
        or not prop.name.isprintable()
    ):
        yield f"a name has 1 to {_LONGEST_NAME} printable characters, on one line."
    elif set(prop.name) & set("|\\"):
        yield "a name must not contain | and \\, since certificates quote it in bars."


def _kind_is_known(prop: Property) -> Iterator[str]:
    if prop.kind not in _KINDS:
        yield f"its kind {prop.kind!r} is none of {', '.join(_KINDS)}; use the functions of these names."


def _terms_are_truth_values(prop: Property) -> Iterator[str]:
    for what, term in (
        ("term", prop.term),
        ("response", prop.response),
        ("further assumption", prop.further_assumption),
    ):
        if not isinstance(term, Bool):
            yield f"its {what} is {term!r}, not a truth-valued term; write TRUE or FALSE for a constant."


def _terms_are_well_formed(prop: Property) -> Iterator[str]:
    yield from malformed([prop.term, prop.response, prop.further_assumption])


def _steps_can_be_counted(prop: Property) -> Iterator[str]:
    if isinstance(prop.steps, bool) or not isinstance(prop.steps, int) or not 0 <= prop.steps < INT64_MAX:
        yield f"its steps is {prop.steps!r}; give a whole number, 0 or more."


PROPERTY: tuple[Rule[Property], ...] = (
    Rule("a property's name can be written", "a crash", _name_can_be_written),
    Rule("a property's kind is known", "a slip", _kind_is_known),
    Rule("a property's terms are truth values", "a slip", _terms_are_truth_values),
    Rule("a property's terms are well formed", "a crash", _terms_are_well_formed),
    Rule("a property's steps can be counted", "a wrong verdict", _steps_can_be_counted),
)


# ------------------------------------------------------------------ on a system


@dataclass(frozen=True, eq=False)
class Reading:
    """A property on a system.

    waiting  of `within`, the variable that counts the steps waited
    helper   the result of the property's helper function for `waiting`; None without one
    """

    system: TransitionSystem
    prop: Property
    waiting: NumVar | None
    helper: object


def _terms_read_what_is_there(reading: Reading) -> Iterator[str]:
    system = reading.system
    known, state = {*system.state, *system.inputs, *system.fired}, set(system.state)
    for var in variables([reading.prop.term, reading.prop.response]):
        if var.before is not None and var.before not in state:
            yield f"it reads {var.name!r}, but before() and was() are for state variables of the system only."
        elif var.before is None and var not in known:
            yield f"it reads {var.name!r}, which {system.name} does not have; read variables of this system only."


def _further_assumption_reads_the_step(reading: Reading) -> Iterator[str]:
    known: set[Var] = {*reading.system.state, *reading.system.inputs}
    for var in variables([reading.prop.further_assumption]):
        if var not in known:
            yield f"the further assumption reads {var.name!r}; it may read state before the step, inputs and ghosts."
    if any(isinstance(node, Past) for node in in_order([reading.prop.further_assumption])):
        yield "the further assumption uses a past operator; express it by state, or move it into the property."


def _helper_speaks_of_states(reading: Reading) -> Iterator[str]:
    """A helper reads no inputs: it is a hypothesis before the step and a goal after it, and an input belongs to one step."""
    if reading.helper is None:
        return
    if not isinstance(reading.helper, Bool):
        yield f"its helper returns {reading.helper!r}; it must return a truth-valued term."
        return
    wrong = list(malformed([reading.helper]))
    yield from wrong
    if wrong:
        return
    allowed: set[Var] = {*reading.system.state} | ({reading.waiting} if reading.waiting is not None else set())
    strange = [repr(var.name) for var in variables([reading.helper]) if var not in allowed]
    if strange:
        yield f"its helper reads {', '.join(strange)}; it may read only state and the number of steps waited, no inputs."
    if any(isinstance(node, Past) for node in in_order([reading.helper])):
        yield "its helper uses a past operator; it may read only state and the number of steps waited."


READING: tuple[Rule[Reading], ...] = (
    Rule("a property reads what is there", "a crash", _terms_read_what_is_there),
    Rule("a further assumption reads the step", "a crash", _further_assumption_reads_the_step),
    Rule("a helper speaks of states", "a wrong verdict", _helper_speaks_of_states),
)


# ------------------------------------------------------------------ together


def _observers_have_distinct_names(goals: Sequence[Goal]) -> Iterator[str]:
    """Observers have distinct names: solvers identify an observer by its name, which contains the property's."""
    seen: dict[str, Goal] = {}
    for goal in goals:
        for var in goal.observers:
            other = seen.setdefault(var.name, goal)
            if other is not goal:
                yield (
                    f"{goal.prop.src}: property {goal.prop.name!r} is checked together with another one of this name "
                    f"({other.prop.src}); rename one of them."
                )


WATCHING: tuple[Rule[Sequence[Goal]], ...] = (
    Rule("observers have distinct names", "a wrong verdict", _observers_have_distinct_names),
)
