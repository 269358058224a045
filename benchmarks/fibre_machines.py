"""How fast the machines of fibre sensing run, each on its simulated stream: python -m benchmarks.fibre_machines.

Steps a second of processor time, and the ratio to the slotted class that is written by hand for the small odometer (three state
variables): that one tells how fast the machine is on which this runs. The target is a million steps a second.
"""

from __future__ import annotations

from collections.abc import Sequence
from dataclasses import dataclass

from benchmarks.by_hand import run_hand_written
from benchmarks.odometer import expected as expected_odometer
from benchmarks.odometer import stream
from benchmarks.turns import Contender, Last, Ready, race
from safeloc.codegen.compiled import Compiled, Row, compile_system
from safeloc.language.interpret import run
from safeloc.language.system import without_ghosts
from safeloc.shipped_machines import ENTRIES

MACHINES = ("fibre", "verification", "axle_head", "axle_counter", "axle_section", "train_order", "emitter")
TARGET = 1e6
UNIT = "hand-written small odometer"
UNIT_STEPS = 20_000
STEPS = 1_000
SEED = 1


@dataclass(frozen=True)
class Loaded:
    """A machine's generated functions and a simulated stream, and the state after it as the interpreter has it."""

    code: Compiled
    rows: list[Row]
    last: Last


def loaded(name: str) -> Loaded:
    """A shipped machine with its default configuration; a short stream begins again at its end."""
    target = ENTRIES[name].make(ENTRIES[name].config())
    assert target.simulate is not None
    system = without_ghosts(target.system)
    names = {var.name for var in system.inputs}
    once = [{key: cell for key, cell in step.items() if key in names} for step in target.simulate(SEED)]
    records = (once * (STEPS // len(once) + 1))[:STEPS]
    code = compile_system(system)
    last = _plain(list(run(system, records).steps[-1].state.values()))
    return Loaded(code, [code.read(record) for record in records], last)


def contenders(name: str, made: Loaded) -> list[Contender]:
    """Step, tick and fused loop of one machine, over its whole stream."""
    count = len(made.rows)
    return [
        Contender(f"{name}, step", count, lambda _: _stepped(made)),
        Contender(f"{name}, tick", count, lambda _: _ticked(made)),
        Contender(f"{name}, fused loop", count, lambda _: lambda: _plain(made.code.run(made.rows, made.code.first()))),
    ]


def _plain(state: Sequence[object]) -> Last:
    return tuple(int(value) for value in state)  # type: ignore[call-overload]


def _stepped(made: Loaded) -> Ready:
    def run_all() -> Last:
        step, state = made.code.step, made.code.first()
        for row in made.rows:
            state, _ = step(state, row)
        return _plain(state)

    return run_all


def _ticked(made: Loaded) -> Ready:
    def run_all() -> Last:
        tick, now = made.code.begin(made.code.first())
        for row in made.rows:
            tick(row)
        return _plain(now())

    return run_all


def _unit() -> Contender:
    rows = stream(UNIT_STEPS)
    return Contender(UNIT, UNIT_STEPS, lambda _: lambda: run_hand_written(rows))


def measured(name: str, rounds: int = 15) -> dict[str, float]:
    """Steps a second of one machine's contenders, and of the unit, taking turns."""
    made = loaded(name)
    ends = {UNIT_STEPS: expected_odometer(UNIT_STEPS), len(made.rows): made.last}
    return race([_unit(), *contenders(name, made)], ends.__getitem__, rounds)


def main() -> None:
    """Print the table; a missed target is shown."""
    print(f"{'':28} {'steps/s':>12}  ratio to {UNIT}")
    for name in MACHINES:
        speeds = measured(name)
        for contender, speed in speeds.items():
            if contender != UNIT:
                missed = "" if speed >= TARGET else "  below a million"
                print(f"{contender:28} {speed:12,.0f}  {speed / speeds[UNIT]:6.3f}{missed}")


if __name__ == "__main__":
    main()
