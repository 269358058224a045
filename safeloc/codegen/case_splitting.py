"""Choice of the cases for which a machine's moves are written separately, so that each computes only the terms it needs.

Three kinds of case are tried, and used if they save enough work:

    a quiet step    all costly optional inputs are absent and no fault condition holds: the usual step of a machine with
                    frequent, mostly good measurements and rare messages
    a mode          terms that only the rows of other modes need are left out
    a condition     a cheap condition: terms that only one side needs are computed only there
"""

from __future__ import annotations

from collections.abc import Iterator, Mapping, Sequence
from dataclasses import dataclass
from functools import cached_property

from safeloc.codegen.merge_choices import chain
from safeloc.codegen.nested_statements import Block, Blocks, Statement, Targets, Test
from safeloc.codegen.simplify_under_facts import Known, implied
from safeloc.codegen.work_of_terms import Works, work
from safeloc.language.nodes import (
    FALSE,
    TRUE,
    And,
    Bool,
    BoolVar,
    Choose,
    ChooseBool,
    Compare,
    Expr,
    Lit,
    Node,
    Not,
    NumVar,
    Or,
    Truth,
    any_of,
)
from safeloc.language.system import TransitionSystem
from safeloc.language.terms import in_order

_WORTH = 1 / 8  # a case must save this share of the work
_LONGEST = 5  # all cases together may have so many times the work
DEEPEST_CASE = 12  # conditions within conditions; a long conjunction is one test
_MOST_LOOKED_AT = 4_000  # nodes that are visited to choose a condition


@dataclass(frozen=True)
class _Case:
    """The targets, simplified under known facts, and the work to compute them."""

    targets: Targets
    work: int

    def under(self, facts: Mapping[Expr, Expr]) -> _Case:
        """Return the case under further facts."""
        return self._folded(self._known.under(facts))

    def decided(self, condition: Bool) -> _Decided:
        """Return the case split by a condition, and the work saved by testing it first, if both results are equally likely."""
        ways = [self._known.under(implied(condition, holds)) for holds in (True, False)]
        holds, fails = (self._folded(known) for known in ways)
        before = sum(self._passing_if(known) for known in ways)
        after = sum(self._passing(one.targets) for one in (holds, fails))
        return _Decided(condition, holds, fails, (before - after) / 2 - self.works([condition]))

    @cached_property
    def _known(self) -> Known:
        """The simplifier that has visited the current terms, as the start of further simplification."""
        known = Known({})
        for _, term in self.targets:
            known(term)
        return known

    @cached_property
    def works(self) -> Works:
        """The work of parts of this case, and of what is left of it under further facts."""
        return Works()

    def _folded(self, known: Known) -> _Case:
        targets = [(name, known(term)) for name, term in self.targets]
        return _Case(targets, self.works(term for _, term in targets))

    @cached_property
    def nodes(self) -> list[Node]:
        """All nodes of the targets."""
        return in_order(term for _, term in self.targets)

    @property
    def passing(self) -> int:
        """The work of a step in which no row's condition holds."""
        return self._passing(self.targets)

    def _passing(self, targets: Targets) -> int:
        needed = 0
        for _, term in targets:
            needed |= self.works.usual(term)
        return needed.bit_count()

    def _passing_if(self, known: Known) -> int:
        """Return the work of a step in which no row's condition holds, except one that is known to hold."""
        needed, needs = 0, self.works.needs
        for _, term in self.targets:
            rows, last = chain(term)
            for condition, value in rows:
                needed |= needs(condition)
                if _is_true(known(condition)):
                    last = value
                    break
            needed |= needs(last)
        return needed.bit_count()


@dataclass(frozen=True)
class _Decided:
    """A case split by a condition: the targets where it holds, where it fails, and the saved work."""

    condition: Bool
    holds: _Case
    fails: _Case
    saved: float


@dataclass(frozen=True)
class _Split:
    """A case split by mode: some modes separately, all others together; the saved work, if all modes are equally likely."""

    mode: NumVar
    apart: Mapping[int, _Case]
    rest: _Case
    saved: float

    @property
    def written(self) -> int:
        """The work of all cases together."""
        return self.rest.work + sum(case.work for case in self.apart.values())


def moves(system: TransitionSystem, targets: Targets, blocks: Blocks, longest: int = _LONGEST) -> Block:
    """Return statements that compute the targets: the moves of a system, or of one stage of it.

    longest  all cases together may have so many times the work of the undivided moves
    """
    undivided = _Case(targets, 0).under({})
    room, modes = undivided.work * longest, _modes(system, undivided)
    events, quiet = _quiet(system, undivided)
    if not events:
        return _by_mode(modes, undivided, blocks, room)
    return blocks.either(
        any_of(events),
        lambda: _by_mode(modes, undivided, blocks, room / 2),
        lambda: _by_mode(modes, quiet, blocks, room / 2),
    )


def _modes(system: TransitionSystem, undivided: _Case) -> list[NumVar]:
    """Return the mode variables that the targets read, whatever their names in the system."""
    units, read = {id(machine.mode.unit) for machine in system.machines}, set(undivided.nodes)
    return [var for var in system.state if isinstance(var, NumVar) and id(var.unit) in units and var in read]


def _quiet(system: TransitionSystem, undivided: _Case) -> tuple[list[Bool], _Case]:
    """Return the conditions that make a step busy, and the case that remains if none of them holds."""
    events: list[Bool] = []
    quiet = undivided
    arrivals = [*_records(system, undivided), *_messages(system, undivided)]
    for find in (lambda _: arrivals, _faults):
        found = find(quiet)
        case = quiet.under({part: known for event in found for part, known in implied(event, False).items()})
        if case.work <= quiet.work * (1 - _WORTH):
            events, quiet = [*events, *found], case
    return events, quiet


def _messages(system: TransitionSystem, undivided: _Case) -> list[Bool]:
    """Return the presence flags of the inputs that cause much of the work."""
    flags = {option.present for option in system.optionals}
    worth = undivided.work * _WORTH
    likely = dict.fromkeys(flag for flag, branch in _guarded(undivided) if flag in flags and work([branch]) >= worth)
    return [flag for flag in likely if undivided.under({flag: FALSE}).work <= undivided.work - worth]


def _records(system: TransitionSystem, undivided: _Case) -> list[Bool]:
    """Return the conditions that a record of several fields is present, for records that cause much of the work."""
    flags = {option.present for option in system.optionals}
    found = [node for node in undivided.nodes if isinstance(node, Or) and flags.issuperset(node.parts)]
    worth = undivided.work * (1 - _WORTH)
    return [node for node in found if undivided.under(implied(node, False)).work <= worth]


def _faults(undivided: _Case) -> list[Bool]:
    """Return fault conditions: for every chain of constants that is compared with its last one, those of the earlier rows."""
    found: dict[Bool, None] = {}
    for node in undivided.nodes:
        if isinstance(node, Compare) and node.op == "==" and isinstance(node.right, Lit):
            rows, last = chain(node.left)
            values = {value.value if isinstance(value, Lit) else None for _, value in rows}
            if isinstance(last, Lit) and last.value == node.right.value and values.isdisjoint({last.value, None}):
                found.update(dict.fromkeys(condition for condition, _ in rows))
    return list(found)


def _guarded(undivided: _Case) -> Iterator[tuple[BoolVar, Expr]]:
    """Yield flags, each with a term that is needed only if it is true."""
    for node in undivided.nodes:
        if isinstance(node, (Choose, ChooseBool)):
            condition, branch = node.condition, node.then
            if isinstance(condition, Not):
                condition, branch = condition.inner, node.other
            if isinstance(condition, BoolVar):
                yield condition, branch


def _by_mode(modes: Sequence[NumVar], undivided: _Case, blocks: Blocks, room: float) -> Block:
    """Return the moves split by the mode that saves most work; without such a mode, split by conditions."""
    worth = [split for split in (_split(mode, undivided, room) for mode in modes) if split.saved >= _WORTH]
    if not worth:
        return _by_condition(undivided, blocks, room)
    best = max(worth, key=lambda split: split.saved)
    others, block = [mode for mode in modes if mode is not best.mode], list[Statement]()
    share = room / max(1, best.written)
    for value, case in best.apart.items():
        inner = _by_mode(others, case, blocks, share * case.work)
        block.append(Test(blocks.text(best.mode.eq(value)), inner))
    return [*block, *_by_mode(others, best.rest, blocks, share * best.rest.work)]


def _by_condition(undivided: _Case, blocks: Blocks, room: float, depth: int = 0) -> Block:
    """Return the moves split by the cheap condition that saves most work; unsplit if no condition saves enough."""
    tried = map(undivided.decided, _cheap(undivided)) if depth < DEEPEST_CASE else ()
    decided = [one for one in tried if one.holds.work + one.fails.work <= room]
    best = max(decided, key=lambda one: one.saved, default=None)
    if best is None or best.saved < undivided.passing * _WORTH:
        return blocks.ending(undivided.targets)
    share = room / max(1, best.holds.work + best.fails.work)
    return blocks.either(
        best.condition,
        lambda: _by_condition(best.holds, blocks, share * best.holds.work, depth + 1),
        lambda: _by_condition(best.fails, blocks, share * best.fails.work, depth),
    )


def _cheap(undivided: _Case) -> list[Bool]:
    """Return cheap conditions on which much work depends, the most work first; fewer conditions for large machines."""
    needs, behind = undivided.works.needs, dict[Bool, int]()
    for condition, branch in _behind(undivided):
        behind[condition] = behind.get(condition, 0) | needs(branch)
    worth = undivided.passing * _WORTH
    found = [(all_needed.bit_count(), one) for one, all_needed in behind.items() if needs(one).bit_count() <= worth]
    found = sorted((one for one in found if one[0] >= worth), key=lambda one: one[0], reverse=True)
    return [condition for _, condition in found[: _MOST_LOOKED_AT // len(undivided.nodes)]]


def _behind(undivided: _Case) -> Iterator[tuple[Bool, Expr]]:
    """Yield conditions, each with a term that is needed only if it holds, or only if it fails."""
    for node in undivided.nodes:
        if isinstance(node, (Choose, ChooseBool)):
            condition = node.condition.inner if isinstance(node.condition, Not) else node.condition
            yield condition, node.then
            yield condition, node.other
        elif isinstance(node, (And, Or)):
            for part in node.parts:
                condition = part.inner if isinstance(part, Not) else part
                yield from ((condition, other) for other in node.parts if other is not part)


def _is_true(term: Expr) -> bool:
    return isinstance(term, Truth) and term.value


def _split(mode: NumVar, undivided: _Case, room: float) -> _Split:
    """Split off as many modes as there is room for, those with the least work first."""
    tests = _tests(mode, undivided)
    cases = {value: undivided.under(_results(tests, [value])) for value in range(mode.low, mode.high + 1)}
    order = sorted(cases, key=lambda value: cases[value].work)
    written, count = undivided.work, 0
    while count < len(order) - 1 and written + cases[order[count]].work <= room:
        written += cases[order[count]].work
        count += 1
    apart, others = sorted(order[:count]), order[count:]
    rest = undivided.under(_results(tests, others)) if apart else undivided
    left = sum(cases[value].work for value in apart) + len(others) * rest.work
    return _Split(mode, {value: cases[value] for value in apart}, rest, 1 - left / len(cases) / max(1, undivided.work))


def _tests(mode: NumVar, undivided: _Case) -> dict[Expr, int]:
    """Return the terms that compare the mode, each with the number of the mode."""
    return {
        node: node.right.value
        for node in undivided.nodes
        if isinstance(node, Compare) and node.op == "==" and node.left is mode and isinstance(node.right, Lit)
    }


def _results(tests: Mapping[Expr, int], values: Sequence[int]) -> dict[Expr, Expr]:
    """Return the known results of these comparisons if the mode is one of the values."""
    return {
        test: TRUE if [value] == list(values) else FALSE
        for test, value in tests.items()
        if value not in values or len(values) == 1
    }
