"""Simulated runs past sections of every making, as steps of the fibre machine in the world of coupling and material.

`python -m safeloc.models.fibre.coupled_runs` writes the runs that ship.
"""

from __future__ import annotations

from collections.abc import Mapping, Sequence

from safeloc.models.fibre.code import Symbol
from safeloc.models.fibre.coupled import CoupledConfig
from safeloc.models.fibre.simulate import RAISED_CDB, Drive, Section, Steps, line, steady
from safeloc.models.fibre.simulate import simulate as run_past
from safeloc.models.fibre.variables import FibreConfig
from safeloc.proof.drawn_runs.worked import WorkedRun, write_named
from safeloc.runtime.streams.steps import Cell

_NOT_HERE = ("true_run_nm", "next_true_edge_nm", "next_true_count", "next_section_is_real", "truth_mm")


def simulate(config: CoupledConfig, *, seed: int) -> Steps:
    """Return a run past twelve sections, from a reference on; of those that raise, and of those that lower, every other one by material."""
    return made_of(config, Drive(steady()), seed)


def made_of(config: CoupledConfig, drive: Drive, seed: int, past: Sequence[Section] | None = None) -> Steps:
    """Return the run as steps: amplitudes, and how the fibre was made where each was received."""
    own = {name: value for name, value in config.model_dump().items() if name in FibreConfig.model_fields}
    plain = FibreConfig(**own)
    steps: Steps = []
    number, inside = {True: 0, False: 0}, False
    for step in run_past(plain, seed=seed, drive=drive, sections=past):
        amplitude = int(step["amplitude_cdb"] or 0)
        changed = abs(amplitude) >= config.change_cdb
        number[amplitude > 0] += int(changed and not inside)
        inside = changed
        kept = {name: cell for name, cell in step.items() if name not in _NOT_HERE}
        steps.append(kept | _made(amplitude, inside=inside, by_material=number[amplitude > 0] % 2 == 0))
    return steps


def _made(amplitude: int, *, inside: bool, by_material: bool) -> dict[str, Cell]:
    """Return how the fibre was made there, and what coupling and material each added."""
    if not inside:
        return {"next_section_made": "BESIDE", "vibration_cdb": amplitude, "sensitivity_cdb": 0}
    if by_material:
        kind, level = ("MORE_SENSITIVE", RAISED_CDB) if amplitude > 0 else ("LESS_SENSITIVE", -RAISED_CDB)
        return {"next_section_made": kind, "vibration_cdb": amplitude - level, "sensitivity_cdb": level}
    return {
        "next_section_made": "COUPLED" if amplitude > 0 else "DAMPED",
        "vibration_cdb": amplitude,
        "sensitivity_cdb": 0,
    }


def _turned_back(config: CoupledConfig) -> Steps:
    past = [Section(100_000, 100_000 + config.long_mm, Symbol(rises=True, long=True))]
    there, back = steady(20_000, 12), steady(-20_000, 8)
    return made_of(config, Drive((*there, *back, *there)), 1, past)


def _endless(config: CoupledConfig) -> Steps:
    past = [Section(100_000, 2_100_000, Symbol(rises=True, long=True))]
    return made_of(config, Drive(steady(cycles=70), referred=False), 3, past)


RUNS: Mapping[str, WorkedRun[CoupledConfig]] = {
    "fibre_coupled-every-making": WorkedRun(
        "Past sections with rods, with dampers, of a more and of a less sensitive guide: each makes one signal, and after the fifth "
        "the word of the position code gives the place.",
        lambda config: made_of(config, Drive(steady(35_000, 280), referred=False), 3, line(config, spacing_mm=750_000)),
    ),
    "fibre_coupled-turned-back": WorkedRun(
        "A located end turns back in a section with rods, and enters it again; one signal for each entry, and none beside the section.",
        _turned_back,
    ),
    "fibre_coupled-no-end": WorkedRun(
        "The cable is coupled to the rail for 2 km: the machine gives up its count, because no section is so long.",
        _endless,
    ),
}
"""The recordings that ship, by name."""


if __name__ == "__main__":
    write_named(__file__, RUNS, {}, CoupledConfig())
