"""Machines as scripts against generated Python, on many steps of all shipped machines; on some also against the interpreter.

    python -m tests.codegen.long_javascript --steps 1000000 --seed 1 --out FILE

Every state, output and fired transition is compared. One step in a hundred is compared with the interpreter as well, and one in a
thousand the reasons for refused transitions and the broken laws. Runs are shipped recordings, recordings with some inputs changed
or left from the middle on, and drawn ones with the world beside the machine.

A block of steps is a line of FILE; started again with the same FILE, it goes on behind the last one. The last line of output is
`N passed, N failed`, of blocks; the exit code is 1 where one failed.
"""

from __future__ import annotations

import argparse
import random
import sys
from collections import Counter
from collections.abc import Mapping, Sequence
from dataclasses import dataclass, field
from functools import lru_cache
from pathlib import Path
from typing import Any

from safeloc.codegen.compiled import Compiled, Row, compile_system
from safeloc.codegen.javascript import on_board
from safeloc.language.expr import Var
from safeloc.language.interpret import outputs, step
from safeloc.language.machine import STAY_NAME
from safeloc.language.nodes import Value
from safeloc.language.system import TransitionSystem
from safeloc.language.trace import present_inputs
from safeloc.proof.drawn_runs.lawful import Repair, first_state
from safeloc.proof.drawn_runs.profiles import FAULTY, PLAUSIBLE, Profile
from safeloc.proof.drawn_runs.sampled import recorded_run
from safeloc.shipped_machines import ENTRIES
from safeloc.target import Target
from tests.codegen import in_node
from tests.codegen.explained import broken, explained
from tests.codegen.in_node import Node, NodeError, as_json, expected, state_told
from tests.kept_lines import keep, kept_lines

A_BLOCK = 500
STRETCH = 12
INTERPRETED_EVERY, EXPLAINED_EVERY = 100, 1000
CHANGED = 0.3  # of the steps of a recording that is not taken as it is
Inputs = dict[Var, Value]


@dataclass(frozen=True, eq=False)
class Bench:
    """A machine, with its world or on board, and the process that runs its script."""

    target: Target
    system: TransitionSystem
    code: Compiled
    node: Node
    repair: Repair

    @property
    def key(self) -> str:
        """The key of the script in the process."""
        return f"{self.target.name}{' with its world' if self.system.ghosts else ''}"


@dataclass
class Outcome:
    """What was seen in a block; `complaint` is the first difference, "" if there is none. `fired` holds each transition once."""

    steps: int = 0
    interpreted: int = 0
    explained: int = 0
    complaint: str = ""
    fired: list[str] = field(default_factory=list)


@lru_cache(maxsize=1)
def _target(name: str) -> Target:
    entry = ENTRIES[name]
    return entry.make(entry.config())


@lru_cache(maxsize=2)
def bench(name: str, whole: bool, node: Node) -> Bench:
    """The machine of the catalogue in the process; on board, or with its world."""
    target = _target(name)
    system = target.system if whole else on_board(target.system)
    made = Bench(target, system, compile_system(system), node, Repair(system))
    node.load(in_node.javascript(system, first=first_state(system, random.Random(0))), made.key)
    return made


# ------------------------------------------------------------------ inputs


@lru_cache(maxsize=64)
def _recording(on: Bench, path: Path) -> tuple[Row, list[Row]]:
    run = recorded_run(on.system, path, 10**9)
    return on.code.first(run.first), [on.code.read(record) for record in run.steps]


def begun(on: Bench, number: int, draw: random.Random) -> tuple[Row, list[Row]]:
    """The state in which a block begins, and the recorded rows that follow: of each recording first all, then from some place."""
    streams = () if on.system.ghosts else on.target.streams
    if not streams:
        return on.code.first(first_state(on.system, draw, adventurous=0.5)), []
    first, rows = _recording(on, streams[number % len(streams)])
    at = 0 if number < len(streams) else draw.randrange(len(rows))
    return on.code.run(rows[:at], first), rows[at:]


class Source:
    """Inputs of a block's steps: stretches of the recording, as it is or with some inputs changed, and drawn stretches."""

    def __init__(self, on: Bench, left: Sequence[Row], draw: random.Random, *, faithful: bool) -> None:
        self._on, self._left, self._draw, self._faithful = on, iter(left), draw, faithful
        self._at, self._follows, self._lawful = 0, True, False
        self._profile = Profile(on.system, "steady", draw)

    def row(self, state: Row) -> Row:
        """The inputs of the next step."""
        if self._at % STRETCH == 0:
            self._profile = Profile(self._on.system, self._draw.choice((*PLAUSIBLE, *FAULTY)), self._draw)
            self._follows = self._faithful or self._draw.random() < 0.7
            self._lawful = self._draw.random() < 0.5
        self._at += 1
        recorded = next(self._left, None)
        if recorded is None or not self._follows:
            return self._row(self._drawn(state))
        is_kept = self._faithful or self._draw.random() > CHANGED
        return recorded if is_kept else self._row(self._changed(recorded, state))

    def _row(self, inputs: Inputs) -> Row:
        return tuple(inputs[var] for var in self._on.system.inputs)

    def _drawn(self, state: Row) -> Inputs:
        before = dict(zip(self._on.system.state, state, strict=True))
        inputs = self._profile.inputs(before)
        mended = self._on.repair.mend(before, inputs, self._draw, self._profile.pick) if self._lawful else None
        return inputs if mended is None else mended

    def _changed(self, recorded: Row, state: Row) -> Inputs:
        """The recorded inputs, some of them drawn; an optional one with its presence."""
        system = self._on.system
        inputs = dict(zip(system.inputs, recorded, strict=True))
        drawn = self._profile.inputs(dict(zip(system.state, state, strict=True)))
        together: list[tuple[Var, ...]] = [(option.value, option.present) for option in system.optionals]
        paired = {var for pair in together for var in pair}
        for group in [*together, *((var,) for var in system.inputs if var not in paired)]:
            if self._draw.random() < 0.1:
                inputs |= {var: drawn[var] for var in group}
        return inputs


# ------------------------------------------------------------------ the comparison


def block(on: Bench, number: int, seed: int, steps: int = A_BLOCK) -> Outcome:
    """So many steps of one run."""
    draw, outcome = random.Random(f"{seed} {on.system.name} {bool(on.system.ghosts)} {number}"), Outcome()
    state, left = begun(on, number, draw)
    source = Source(on, left, draw, faithful=number < len(on.target.streams))
    on.node.choose(on.key)
    on.node.ask("put", as_json(dict(zip(on.code.state_names, state, strict=True))))
    fired: dict[tuple[str, str], None] = {}
    interpreted, explains = draw.randrange(INTERPRETED_EVERY), draw.randrange(EXPLAINED_EVERY)
    for at in range(steps):
        row = source.row(state)
        complaint = ""
        if at % INTERPRETED_EVERY == interpreted:
            outcome.interpreted += 1
            complaint = _interpreted(on, state, row)
        if at % EXPLAINED_EVERY == explains:
            outcome.explained += 1
            complaint = complaint or _explained(on, state, row)
        complaint = complaint or _differs(on, state, row)
        if complaint:
            outcome.complaint = f"{on.system.name}, block {number}, step {at}: {complaint}"
            break
        state, numbers = on.code.step(state, row)
        fired |= dict.fromkeys(on.code.fired(numbers).items())
        outcome.steps += 1
    outcome.fired = sorted(f"{machine.removesuffix('.fired')}: {name}" for machine, name in fired if name != STAY_NAME)
    return outcome


def _given(on: Bench, row: Row) -> dict[str, object]:
    return as_json(present_inputs(on.system, dict(zip(on.code.input_names, row, strict=True))))


def _differs(on: Bench, state: Row, row: Row) -> str:
    """What the script makes of a step otherwise than generated Python."""
    try:
        found = on.node.ask("step", _given(on, row))
    except NodeError as error:
        return str(error)
    right = expected(on.code, *on.code.step(state, row))
    return "" if found == right else f"{_difference(found, right)} from {state} with {row}"


def _difference(found: Mapping[str, Any], right: Mapping[str, Any]) -> str:
    told = [f"fired {found['fired']}, not {right['fired']}"] if found["fired"] != right["fired"] else []
    for part in ("state", "outputs"):
        told += [
            f"{name} {found[part].get(name)}, not {one}"
            for name, one in right[part].items()
            if found[part].get(name) != one
        ]
    return "; ".join(told) or "more values than there are"


def _interpreted(on: Bench, state: Row, row: Row) -> str:
    """What generated Python, and so the script, makes of a step otherwise than the interpreter."""
    before, inputs = dict(zip(on.system.state, state, strict=True)), dict(zip(on.system.inputs, row, strict=True))
    after, fired = step(on.system, before, inputs)
    moved, numbers = on.code.step(state, row)
    kept = tuple(after[var] for var in on.system.state)
    same = (kept, tuple(fired.values()), outputs(on.system, after)) == (moved, numbers, on.code.named_outputs(moved))
    return "" if same else f"the interpreter comes to {state_told(on.system, kept)}"


def _explained(on: Bench, state: Row, row: Row) -> str:
    """Which reasons or broken laws the script tells otherwise than `safeloc step`."""
    before, inputs = dict(zip(on.system.state, state, strict=True)), dict(zip(on.system.inputs, row, strict=True))
    for method, right in (
        ("explain", explained(on.system, before, inputs)),
        ("broken", broken(on.system, before, inputs)),
    ):
        found = on.node.ask("call", method, _given(on, row))
        if found != right:
            return f"{method} tells {found}, not {right}"
    return ""


# ------------------------------------------------------------------ the long run


def search(names: Sequence[str], steps: int, seed: int, out: Path) -> tuple[Outcome, int, int]:
    """Blocks of all machines until that many steps were compared; returns what was seen, and the blocks that passed and failed."""
    blocks = max(2, -(-steps // (len(names) * A_BLOCK)))
    done = {(one["machine"], one["block"]): one for one in kept_lines(out) if one["seed"] == seed}
    total, verdicts, node = Outcome(), Counter[bool](), Node()
    try:
        for name in names:
            for number in range(blocks):
                if (name, number) not in done:
                    found = block(bench(name, number % 2 == 1, node), number // 2, seed)
                    done[name, number] = {"seed": seed, "machine": name, "block": number, **vars(found)}
                    keep(out, done[name, number])
                _add(total, verdicts, done[name, number])
            print(f"{name}: {total.steps} steps in all, {verdicts[False]} blocks failed", flush=True)
    finally:
        node.close()
    return total, verdicts[True], verdicts[False]


def _add(total: Outcome, verdicts: Counter[bool], line: Mapping[str, Any]) -> None:
    total.steps += line["steps"]
    total.interpreted += line["interpreted"]
    total.explained += line["explained"]
    total.fired = sorted({*total.fired, *(f"{line['machine']}: {one}" for one in line["fired"])})
    verdicts[not line["complaint"]] += 1
    if line["complaint"]:
        print(line["complaint"], flush=True)


def main(arguments: Sequence[str] | None = None) -> int:
    """0: every step agreed. 1: one differed."""
    parser = argparse.ArgumentParser(description="Machines as scripts against generated Python.")
    parser.add_argument("--steps", type=int, default=1_000_000)
    parser.add_argument("--seed", type=int, default=1)
    parser.add_argument("--machine", action="append", choices=list(ENTRIES), help="one machine alone; may be repeated")
    parser.add_argument("--out", type=Path, required=True, help="a line a block; read again to go on")
    asked = parser.parse_args(arguments)
    total, passed, failed = search(asked.machine or list(ENTRIES), asked.steps, asked.seed, asked.out)
    print(f"{len(total.fired)} transitions fired")
    print(
        f"{total.steps} steps, {total.interpreted} with the interpreter as well, {total.explained} with their reasons"
    )
    print(f"{passed} passed, {failed} failed")
    return 1 if failed else 0


if __name__ == "__main__":
    sys.exit(main())
