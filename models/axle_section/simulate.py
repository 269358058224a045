"""Simulated trains through a section between axle counters, with its resets and sweeps, as steps of the section machine.

`python -m safeloc.models.axle_section.simulate` writes the runs that ship, `... simulate FOLDER` those that are made on demand.
"""

from __future__ import annotations

from collections.abc import Callable, Mapping, Sequence
from dataclasses import dataclass, field, replace
from random import Random

from safeloc.models.axle_section import AxleSectionConfig
from safeloc.proof.drawn_runs.worked import Steps, WorkedRun, write_named
from safeloc.runtime.streams.steps import Cell

SIDES = ("low", "high")
_AXLES_A_CYCLE = 8
QUIET: Mapping[str, Cell] = {
    "axles_in_low": 0, "axles_in_high": 0, "axles_out_low": 0, "axles_out_high": 0, "head_fault": False,
    "head_damped": False, "reset_requested": False, "sweep_reported_clear": False,
}  # fmt: skip


@dataclass(frozen=True)
class Event:
    """Several cycles with equal inputs.

    cells    inputs that differ from quiet ones
    cycles   number of cycles
    unseen   axles that came in (left: negative) in each cycle without being reported
    sweep    head that the first or last axle of a sweep passes
    """

    cells: Mapping[str, Cell] = field(default_factory=dict)
    cycles: int = 1
    unseen: int = 0
    sweep: str = "NO_HEAD"


Events = Sequence[Event]
RESET = Event({"reset_requested": True})


def quiet(cycles: int) -> Event:
    """Return cycles in which nothing happens."""
    return Event(cycles=cycles)


def train(axles: int, way: str, side: str, *, sweeps: bool = False) -> list[Event]:
    """Return a train counted `in` or `out` at the `low` or the `high` side; between its cycles a wheel stands on the head."""
    full, rest = divmod(axles, _AXLES_A_CYCLE)
    counts = [*[_AXLES_A_CYCLE] * full, *([rest] if rest else [])]
    last = len(counts) - 1
    passages = [
        Event({f"axles_{way}_{side}": count, "head_damped": number < last}) for number, count in enumerate(counts)
    ]
    if sweeps:
        over = 0 if way == "in" else last
        passages[over] = replace(passages[over], sweep=f"{way}_{side}".upper())
    return passages


def through(axles: int, cycles: int = 12, *, sweeps: bool = False) -> list[Event]:
    """Return a train that comes in at the low side and leaves at the high side."""
    return [*train(axles, "in", "low", sweeps=sweeps), quiet(cycles), *train(axles, "out", "high", sweeps=sweeps)]


def swept(config: AxleSectionConfig) -> list[Event]:
    """Return a reset after the lead time, a sweep by eight axles, and its report."""
    report = Event({"sweep_reported_clear": True})
    return [quiet(config.lead_cycles), RESET, *through(8, 20, sweeps=True), quiet(2), report]


def happened(events: Events) -> Steps:
    """Return one step per cycle, with the axles that really passed, unless some axles were not reported."""
    all_seen = all(event.unseen == 0 for event in events)
    steps = [_step(event) for event in events for _ in range(event.cycles)]
    return (
        steps if all_seen else [{name: value for name, value in step.items() if "true" not in name} for step in steps]
    )


def _step(event: Event) -> dict[str, Cell]:
    cells = {**QUIET, **event.cells}
    passed = {f"true_axles_{way}_{side}": cells[f"axles_{way}_{side}"] for way in ("in", "out") for side in SIDES}
    return {**cells, **passed, "true_sweep_passes": event.sweep}


def simulate(config: AxleSectionConfig, *, seed: int) -> Steps:
    """Return reset, sweep, and eight trains, some of which turn back in the section."""
    rng = Random(seed)
    events = swept(config)
    for _ in range(8):
        axles, side = rng.randint(4, 60), rng.choice(SIDES)
        stays, leaves = quiet(rng.randint(4, 60)), rng.choice(SIDES)
        events += [*train(axles, "in", side), stays, *train(axles, "out", leaves), quiet(rng.randint(2, 30))]
    return happened(events)


# ------------------------------------------------------------------ named runs


def _service(config: AxleSectionConfig) -> Events:
    return [
        *swept(config),
        *through(36),
        quiet(5),
        *train(20, "in", "high"),
        quiet(9),
        *train(20, "out", "high"),
        quiet(3),
    ]


def _refused(config: AxleSectionConfig) -> Events:
    """Request a reset in vain: right after power-up, with a train in, with a wheel on a head; then the train leaves."""
    stays = quiet(config.lead_cycles + 2)
    damped = Event({"reset_requested": True, "head_damped": True})
    return [RESET, *swept(config), *train(36, "in", "low"), stays, RESET, damped, *train(36, "out", "high"), quiet(3)]


def _disturbed(config: AxleSectionConfig) -> Events:
    """Lose the direction of an axle; request a reset in vain while the head is disturbed; then reset and sweep."""
    fault = Event({"head_fault": True}, 3)
    refused = Event({"head_fault": True, "reset_requested": True})
    arrives, leaves = train(36, "in", "low"), train(36, "out", "high")
    return [*swept(config), *arrives, fault, refused, quiet(4), *leaves, *swept(config), *through(12), quiet(3)]


def _miscount(config: AxleSectionConfig) -> Events:
    """Let an axle in uncounted and count it out: more out than in."""
    lost = [*train(19, "in", "low"), Event(unseen=1)]
    return [*swept(config), *lost, quiet(9), *train(20, "out", "high"), *swept(config), *through(12), quiet(3)]


def _sweep_turns(config: AxleSectionConfig) -> Events:
    """Turn the first sweep back, so that it counts for nothing; then reset and sweep once more."""
    there, back = train(8, "in", "low", sweeps=True), train(8, "out", "low", sweeps=True)
    backs_out = [*there, quiet(9), *back, Event({"sweep_reported_clear": True})]
    return [quiet(config.lead_cycles), RESET, *backs_out, *swept(config), quiet(3)]


def _worked(outcome: str, events: Callable[[AxleSectionConfig], Events]) -> WorkedRun[AxleSectionConfig]:
    return WorkedRun(outcome, lambda config: happened(events(config)))


RUNS: Mapping[str, WorkedRun[AxleSectionConfig]] = {
    "axle_section-service": _worked(
        "Occupied from power-up until a reset and a sweep through; then clear, occupied by each train, and clear again.",
        _service,
    ),
    "axle_section-reset-refused": _worked(
        "A reset is refused while axles are counted in or a head is damped; the section stays occupied until the train is out.",
        _refused,
    ),
    "axle_section-disturbed": _worked(
        "Direction unknown: disturbed, also when the fault is gone and the train is out; clear only after reset and sweep.",
        _disturbed,
    ),
    "axle_section-sweep-turns": _worked(
        "A sweep that turns back does not clear the section; one that runs through does.", _sweep_turns
    ),
}
"""The recordings that ship, by name."""
ON_DEMAND: Mapping[str, WorkedRun[AxleSectionConfig]] = {
    "axle_section-miscount": _worked(
        "One more axle out than in: disturbed in that cycle; clear only after reset and sweep.", _miscount
    ),
}
"""Runs that do not ship, by name: another one shows each of their transitions and cases."""


if __name__ == "__main__":
    write_named(__file__, RUNS, ON_DEMAND, AxleSectionConfig())
