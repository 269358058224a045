"""States that were damaged: check_state lets none pass from which a step leaves the ranges, and C goes on as the interpreter."""

from __future__ import annotations

import random
import re
import subprocess
from collections.abc import Mapping
from dataclasses import replace
from pathlib import Path

import pytest

from safeloc.codegen.c99 import STRICT, library_texts, to_c
from safeloc.codegen.c99_layout import layout_of
from safeloc.codegen.c_loader import CMachine, load_c
from safeloc.errors import InputError
from safeloc.language.expr import NumVar, Var, number
from safeloc.language.interpret import read_inputs, run, step
from safeloc.language.machine import Machine, Transition, modes
from safeloc.language.nodes import Value
from safeloc.language.system import TransitionSystem, lower, without_ghosts
from safeloc.language.units import MM
from safeloc.proof.drawn_runs.sampled import drawn_run
from safeloc.proof.provers.lasting import lasting
from safeloc.shipped_machines import ENTRIES
from tests.codegen.c_folder import make, needs_compiler, runs_of, written

pytestmark = needs_compiler

State = dict[str, Value]


def shipped(name: str) -> TransitionSystem:
    """One of the shipped systems, with its world."""
    return ENTRIES[name].make(ENTRIES[name].config()).system


def reached(system: TransitionSystem) -> list[State]:
    """States of drawn runs, lawful and not."""
    board = without_ghosts(system)
    traces = [run(board, one.steps, first=one.first) for one in runs_of(system)]
    return [dict(one.state) for trace in traces for one in trace.steps]


def damaged(system: TransitionSystem, state: State, draw: random.Random) -> State:
    """The state with one to three values replaced, or all: ends of the range, values near them, another variable's, any."""
    values = dict(state)
    for var in draw.sample(system.state, min(len(system.state), draw.choice([1, 2, 3, len(system.state)]))):
        values[var.name] = wrong(var, list(state.values()), draw)
    return values


def wrong(var: Var, others: list[Value], draw: random.Random) -> Value:
    """Some other value in its range."""
    if not isinstance(var, NumVar):
        return draw.random() < 0.5
    near = [
        var.low,
        var.high,
        var.low + 1,
        var.high - 1,
        var.low + draw.randint(0, 1_000),
        draw.randint(var.low, var.high),
    ]
    near += [int(one) for one in others]
    return draw.choice([value for value in near if var.low <= value <= var.high])


def leaves(system: TransitionSystem, state: Mapping[Var, Value]) -> list[str]:
    """Variables out of their ranges."""
    numbers = [var for var in system.state if isinstance(var, NumVar)]
    return [var.name for var in numbers if not var.low <= state[var] <= var.high]


def followed(machine: CMachine, state: State, seed: int, steps: int) -> list[str]:
    """What leaves its range in steps from this state; C and the interpreter agree in each."""
    system = machine.system
    values: Mapping[Var, Value] = {var: state[var.name] for var in system.state}
    for record in drawn_run(system, seed, steps, lawful=False).steps:
        values, _ = step(system, values, read_inputs(system, record))
        if out := leaves(system, values):
            return out
        machine.step(record)
        assert machine.state == {var.name: values[var] for var in system.state}
    return []


def taken(machine: CMachine, state: State) -> bool:
    """Whether check_state lets it pass; in its ranges it is in any case."""
    try:
        machine.put(state)
    except InputError as error:
        if "no step leads to such a state" not in str(error):
            raise
        return False
    return True


def survivors(machine: CMachine, system: TransitionSystem, tries: int) -> list[State]:
    """Damaged states that pass."""
    draw, states = random.Random(1), reached(system)
    wanted = (damaged(machine.system, draw.choice(states), draw) for _ in range(tries))
    return [state for state in wanted if taken(machine, state)]


def loaded(system: TransitionSystem, folder: Path, *, proved: bool = True) -> CMachine:
    """What runs on board, in C, with what is proved of every state or without."""
    kept = lasting(system) if proved else None
    return load_c(without_ghosts(system), folder=folder, first=runs_of(system)[0].first, kept=kept)


def holds_for(name: str, folder: Path, tries: int, steps: int) -> None:
    """No step from a damaged state that passes leaves the ranges; and the check is asked something."""
    system = shipped(name)
    machine = loaded(system, folder)
    passed = survivors(machine, system, tries)
    assert tries // 50 < len(passed) < tries
    for place, state in enumerate(passed):
        machine.put(state)
        assert followed(machine, state, place % 20, steps) == [], state


@pytest.mark.thorough(ordinary=1)
@pytest.mark.parametrize("name", ["route", "turn_off", "transmission"])
def test_a_damaged_state_that_passes_never_leaves_its_ranges(name: str, tmp_path: Path) -> None:
    """Whatever the inputs."""
    holds_for(name, tmp_path, 150, 12)


@pytest.mark.slow
@pytest.mark.parametrize("name", sorted(set(ENTRIES) - {"delocalized", "stop_point", "emitter", "localizer"}))
def test_all_shipped_machines(name: str, tmp_path: Path) -> None:
    """The same, longer; of those left out nothing beside ranges is to be kept, or proving it takes too long here."""
    holds_for(name, tmp_path, 400, 12)


@pytest.mark.thorough
@pytest.mark.parametrize("name", ["sections"])
def test_ranges_alone_are_not_enough(name: str, tmp_path: Path) -> None:
    """What is proved is needed: with ranges alone, a step from some state that passes leaves them."""
    system = shipped(name)
    machine = loaded(system, tmp_path, proved=False)
    passed = survivors(machine, system, 400)
    assert len(passed) == 400
    assert any(leaves_its_ranges(machine.system, state, place % 20) for place, state in enumerate(passed))


def leaves_its_ranges(system: TransitionSystem, state: State, seed: int) -> bool:
    """Whether a step does, of a few with any inputs."""
    values: Mapping[Var, Value] = {var: state[var.name] for var in system.state}
    for record in drawn_run(system, seed, 5, lawful=False).steps:
        values, _ = step(system, values, read_inputs(system, record))
        if leaves(system, values):
            return True
    return False


@pytest.mark.thorough
def test_every_state_of_a_run_passes(tmp_path: Path) -> None:
    """Also of runs that break what is assumed of the world: the folder's own check asks it after each step."""
    system = shipped("axle_head")
    kept = lasting(system)
    assert kept is not None
    assert kept.keys() < system.lemmas.keys()  # some hold under the assumption only, and are not asked
    for name in ("axle_head", "sections"):
        system = shipped(name)
        files = to_c(without_ghosts(system), runs_of(system), kept=lasting(system))
        assert "check_state(state), " in files["check.c"]
        code, printed = make(written(tmp_path / name, files), "check", "sanitize")
        assert code == 0, printed


# ------------------------------------------------------------------ states that nobody set

_ASKED = """#include "bounds.h"
#include <stdio.h>
#include <string.h>

static void ask(const char *what, bounds_state state)
{
    const bounds_inputs inputs[2] = {{0}, {0}};
    const bounds_state before = state;
    bounds_outputs outputs;
    bounds_snapshot snapshot;
    size_t done = 7;
    memset(&outputs, 0x55, sizeof outputs);
    const bounds_outputs kept = outputs;
    int32_t said[5];
    said[0] = bounds_step(&state, inputs, &outputs);
    said[1] = bounds_show(&state, &outputs);
    said[2] = bounds_run(&state, inputs, &outputs, 2, &done);
    said[3] = bounds_save(&state, &snapshot);
    said[4] = bounds_check_state(&state);
    printf("%s:", what);
    for (int number = 0; number < 5; number++) {
        printf(" %d", (int)said[number]);
    }
    printf(", %d steps, %s\\n", (int)done, memcmp(&state, &before, sizeof state) || memcmp(&outputs, &kept, sizeof kept) ? "moved" : "nothing moved");
}

int main(void)
{
    bounds_state state;
    memset(&state, 0, sizeof state);
    ask("zeros", state);
    memset(&state, 0xAA, sizeof state);
    ask("0xAA", state);
    state.declaration = BOUNDS_DECLARATION;
    ask("0xAA with the mark", state);
    if (bounds_init(&state) != BOUNDS_OK) {
        return 1;
    }
    state.high = INT64_MAX - 2;
    ask("near the end of 64 bits", state);
    state.high = 11;
    ask("in its ranges, reached by no step", state);
    return 0;
}
"""


def test_no_function_takes_a_state_that_was_not_set(tmp_path: Path) -> None:
    """Zeros and bytes that memory held, values beyond their ranges, and what no step leads to: each is refused by every
    function that reads a state, and nothing moves, also under the sanitizers."""
    system = counting(lemma=True)
    folder = written(tmp_path, {**to_c(system, runs_of(system), kept=lasting(system)), "ask.c": _ASKED})
    sanitizers = ["-fsanitize=address,undefined", "-fno-sanitize-recover=all"]
    command = ["cc", *STRICT, *sanitizers, "-o", "ask", "ask.c", "bounds.c"]
    built = subprocess.run(command, cwd=folder, capture_output=True, text=True, check=False)
    assert built.returncode == 0, built.stderr
    asked = subprocess.run([str(folder / "ask")], capture_output=True, text=True, check=False)
    assert asked.stderr == ""
    assert asked.stdout.splitlines() == [
        "zeros: 7 7 7 7 7, 0 steps, nothing moved",
        "0xAA: 7 7 7 7 7, 0 steps, nothing moved",
        "0xAA with the mark: 2 2 2 2 2, 0 steps, nothing moved",
        "near the end of 64 bits: 2 2 2 2 2, 0 steps, nothing moved",
        "in its ranges, reached by no step: 6 6 6 6 6, 0 steps, nothing moved",
    ]


def counting(*, lemma: bool, inside: bool = True) -> TransitionSystem:
    """Two bounds that are moved together; that they are apart by 10 keeps the second one in its range."""
    (on,) = table = modes("ON")
    low, high = number("low", MM, 0, 100), number("high", MM, 0, 110 if inside else 109)
    move = Transition("up", on, on, when=low < 100, set={low: low + 1, high: high + 1})
    lemmas = {"ten apart": high.eq(low + 10)} if lemma else {}
    return lower(Machine("bounds", table, [], {low: 0, high: 10}, {}, [move], lemmas=lemmas))


def test_what_is_not_proved_is_not_asked() -> None:
    """Without the fact the range is not inductive; with a range that is really left, nothing is claimed."""
    assert lasting(counting(lemma=True)) is not None
    assert list(lasting(counting(lemma=True)) or ()) == ["ten apart"]
    assert lasting(counting(lemma=False)) is None
    assert lasting(counting(lemma=True, inside=False)) is None


def test_the_texts_say_which(tmp_path: Path) -> None:
    """Header and README of what is proved, and of what is not."""
    system = counting(lemma=True)
    proved = to_c(system, runs_of(system), kept=lasting(system))
    not_known = to_c(system, runs_of(system))
    assert "never leave the ranges" in " ".join(proved["bounds.h"].split())
    assert "/* Proved of every state: ten apart. */" in proved["bounds.c"]
    assert "BOUNDS_STATE_UNSOUND" in proved["bounds.h"]
    assert "STATE_UNSOUND" not in not_known["bounds.h"]
    assert not re.search("\n\n\n", not_known["README.md"])  # nothing is said of the machine, and no gap is left for it
    assert "It is not proved that every step leads into the ranges" in " ".join(not_known["README.md"].split())
    digests = [layout_of(system, kept).digest for kept in (lasting(system), None)]
    assert digests[0] == digests[1]  # snapshots fit both
    machine = load_c(system, folder=tmp_path, kept=lasting(system))
    machine.put({"mode": 0, "low": 90, "high": 100})
    with pytest.raises(InputError, match="no step leads to such a state"):
        machine.put({"mode": 0, "low": 90, "high": 110})
    with pytest.raises(InputError, match="a state variable is out of its range"):
        machine.put({"mode": 0, "low": 101, "high": 111})
    with pytest.raises(InputError, match="a value for each of its variables"):
        machine.put({"low": 90})
    assert machine.state["high"] == 100
    assert library_texts(layout_of(replace(system, lemmas={})))["bounds.c"] == not_known["bounds.c"]
