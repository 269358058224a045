"""Which cases a machine's moves are written out for apart, so that each computes only what it needs.

Two kinds of case are tried, and kept where they pay:

    a quiet step    none of the optional inputs is there that make much of the work: the usual step of a machine
                    that measures often and gets messages seldom
    a mode          what only the other modes' rows need is left out
"""

from __future__ import annotations

from collections.abc import Iterator, Mapping, Sequence
from dataclasses import dataclass

from safeloc.backends.known import Known, work
from safeloc.backends.python_blocks import Block, Blocks, Statement, Targets, Test
from safeloc.nodes import FALSE, TRUE, BoolVar, Choose, ChooseBool, Compare, Expr, Lit, Node, Not, NumVar, Var, any_of
from safeloc.system import TransitionSystem
from safeloc.terms import in_order

WORTH = 1 / 8  # a case must save this share of the work
LONGEST = 3  # all cases together may have so many times the work written out


@dataclass(frozen=True)
class _Case:
    """What is left of the targets where something is known, and how much work that is."""

    targets: Targets
    work: int

    def under(self, facts: Mapping[Expr, Expr]) -> _Case:
        """The case in which more is known."""
        known = Known(facts)
        targets = [(name, known(term)) for name, term in self.targets]
        return _Case(targets, work([term for _, term in targets]))

    def nodes(self) -> list[Node]:
        """All that it is made of."""
        return in_order(term for _, term in self.targets)


def moves(system: TransitionSystem, names: Mapping[Var, str]) -> Block:
    """Statements that compute the state after a step (`next_...`), then the fired transitions (`fired_...`)."""
    moved = [(f"next_{names[var]}", system.next[var]) for var in system.state]
    fired = [(f"fired_{number}", term) for number, term in enumerate(system.fired.values())]
    whole, blocks = _Case([*moved, *fired], 0).under({}), Blocks(names)
    room, modes = whole.work * LONGEST, [machine.mode for machine in system.machines]
    events = _events(system, whole)
    if not events:
        return _by_mode(modes, whole, blocks, room)
    busy = Test(blocks.text(any_of(events)), blocks.ending(whole.targets))
    return [busy, *_by_mode(modes, whole.under(dict.fromkeys(events, FALSE)), blocks, room - whole.work)]


def _events(system: TransitionSystem, whole: _Case) -> list[BoolVar]:
    """Presence flags of the inputs that make much of the work."""
    flags = {option.present for option in system.optionals}
    worth = whole.work * WORTH
    likely = dict.fromkeys(flag for flag, branch in _guarded(whole) if flag in flags and work([branch]) >= worth)
    return [flag for flag in likely if whole.under({flag: FALSE}).work <= whole.work - worth]


def _guarded(whole: _Case) -> Iterator[tuple[BoolVar, Expr]]:
    """Flags, and terms that are needed only where they hold."""
    for node in whole.nodes():
        if isinstance(node, (Choose, ChooseBool)):
            condition, branch = node.condition, node.then
            if isinstance(condition, Not):
                condition, branch = condition.inner, node.other
            if isinstance(condition, BoolVar):
                yield condition, branch


def _by_mode(modes: Sequence[NumVar], whole: _Case, blocks: Blocks, room: float) -> Block:
    """The moves mode by mode, for the machine where that saves most; as they are where it saves too little."""
    tried = {mode: _cases(mode, whole) for mode in modes}
    written = {mode: sum(case.work for case in cases) for mode, cases in tried.items()}
    worth = [mode for mode in modes if written[mode] <= room and _saved(written[mode], mode, whole) >= WORTH]
    if not worth:
        return blocks.ending(whole.targets)
    best = max(worth, key=lambda mode: _saved(written[mode], mode, whole))
    others, block = [mode for mode in modes if mode is not best], list[Statement]()
    for value, case in enumerate(tried[best], best.low):
        inner = _by_mode(others, case, blocks, room * case.work / max(1, written[best]))
        block += [Test(blocks.text(best.eq(value)), inner)] if value < best.high else inner
    return block


def _saved(written: int, mode: NumVar, whole: _Case) -> float:
    """The share of the work that is saved, all modes being equally likely."""
    return 1 - written / (mode.high - mode.low + 1) / max(1, whole.work)


def _cases(mode: NumVar, whole: _Case) -> list[_Case]:
    """What is left in every mode."""
    tests = {
        node: node.right.value
        for node in whole.nodes()
        if isinstance(node, Compare) and node.op == "==" and node.left is mode and isinstance(node.right, Lit)
    }
    return [
        whole.under({test: TRUE if value == named else FALSE for test, named in tests.items()})
        for value in range(mode.low, mode.high + 1)
    ]
