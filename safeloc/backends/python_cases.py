"""Which cases a machine's moves are written out for apart, so that each computes only what it needs.

Two kinds of case are tried, and kept where they pay:

    a quiet step    none of the optional inputs is there that make much of the work: the usual step of a machine
                    that measures often and gets messages seldom
    a mode          what only the other modes' rows need is left out
"""

from __future__ import annotations

from collections.abc import Mapping, Sequence

from safeloc.backends.known import Known, work
from safeloc.backends.python_blocks import Block, Blocks, Targets, Test
from safeloc.nodes import FALSE, TRUE, BoolVar, Choose, ChooseBool, Compare, Expr, Lit, Not, NumVar, Var, any_of
from safeloc.system import TransitionSystem
from safeloc.terms import in_order

WORTH = 1 / 8  # a case must save this share of the work
LONGEST = 3  # all cases together may have so many times the work written out


def moves(system: TransitionSystem, names: Mapping[Var, str]) -> Block:
    """Statements that compute the state after a step (`next_...`), then the fired transitions (`fired_...`)."""
    moved = [(f"next_{names[var]}", system.next[var]) for var in system.state]
    fired = [(f"fired_{number}", term) for number, term in enumerate(system.fired.values())]
    targets, blocks = _under({}, [*moved, *fired]), Blocks(names)
    room, modes = _work(targets) * LONGEST, [machine.mode for machine in system.machines]
    events = _events(system, targets)
    if not events:
        return _by_mode(modes, targets, blocks, room)
    busy = Test(blocks.text(any_of(events)), blocks.ending(targets))
    quiet = _under(dict.fromkeys(events, FALSE), targets)
    return [busy, *_by_mode(modes, quiet, blocks, room - _work(targets))]


def _events(system: TransitionSystem, targets: Targets) -> list[BoolVar]:
    """Presence flags of the inputs that make much of the work."""
    whole = _work(targets)
    guarded = _guarded(targets)
    flags = [option.present for option in system.optionals if guarded.get(option.present, 0) >= whole * WORTH]
    return [flag for flag in flags if _work(_under({flag: FALSE}, targets)) <= whole * (1 - WORTH)]


def _guarded(targets: Targets) -> dict[Expr, int]:
    """Flag -> at most how much work is done only where it holds: a quick estimate, to try few flags."""
    found: dict[Expr, int] = {}
    for node in in_order(term for _, term in targets):
        if not isinstance(node, (Choose, ChooseBool)):
            continue
        condition, branch = node.condition, node.then
        if isinstance(condition, Not):
            condition, branch = condition.inner, node.other
        if isinstance(condition, BoolVar):
            found[condition] = max(found.get(condition, 0), work([branch]))
    return found


def _by_mode(modes: Sequence[NumVar], targets: Targets, blocks: Blocks, room: float) -> Block:
    """The moves mode by mode, for the machine where that saves most; as they are where it saves too little."""
    whole = _work(targets)
    tried = [(mode, _cases(mode, targets)) for mode in modes]
    worth = [(mode, cases) for mode, cases in tried if _mean(cases) <= whole * (1 - WORTH) and _sum(cases) <= room]
    if not worth:
        return blocks.ending(targets)
    best, cases = min(worth, key=lambda one: _mean(one[1]))
    others, block = [mode for mode in modes if mode is not best], list[Block]()
    for value, case in cases.items():
        inner = _by_mode(others, case, blocks, room * _work(case) / max(1, _sum(cases)))
        block.append([Test(blocks.text(best.eq(value)), inner)] if value < best.high else inner)
    return [statement for part in block for statement in part]


def _cases(mode: NumVar, targets: Targets) -> dict[int, Targets]:
    """What is left of the targets in every mode."""
    tests = {
        node: node.right.value
        for node in in_order(term for _, term in targets)
        if isinstance(node, Compare) and node.op == "==" and node.left is mode and isinstance(node.right, Lit)
    }
    return {
        value: _under({test: TRUE if value == named else FALSE for test, named in tests.items()}, targets)
        for value in range(mode.low, mode.high + 1)
    }


def _under(facts: Mapping[Expr, Expr], targets: Targets) -> Targets:
    known = Known(facts)
    return [(name, known(term)) for name, term in targets]


def _work(targets: Targets) -> int:
    return work([term for _, term in targets])


def _sum(cases: Mapping[int, Targets]) -> int:
    return sum(map(_work, cases.values()))


def _mean(cases: Mapping[int, Targets]) -> float:
    return _sum(cases) / len(cases)
