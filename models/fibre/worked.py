"""Worked runs of the fibre machine, as features, beside the figures of the source.

`python -m safeloc.models.fibre.worked` writes the runs that ship.
"""

from __future__ import annotations

from collections.abc import Mapping

from safeloc.models.fibre.code import Symbol
from safeloc.models.fibre.simulate import Drive, Section, simulate, steady
from safeloc.models.fibre.variables import FibreConfig
from safeloc.proof.drawn_runs.worked import Steps, WorkedRun, write_named


def _endless(config: FibreConfig) -> Steps:
    """Run along 2 km of raised amplitude, with nothing known before."""
    stretch = [Section(100_000, 2_100_000, Symbol(rises=True, long=True))]
    return simulate(config, seed=3, drive=Drive(steady(cycles=70), referred=False), sections=stretch)


def _endless_where_located(config: FibreConfig) -> Steps:
    """Run past a section of the map from a known place; the amplitude stays raised behind the section's end."""
    stretch = [Section(100_000, 100_000 + config.long_mm, Symbol(rises=True, long=True))]
    drive = Drive(steady(cycles=60), stuck_mm=(100_000, 2_000_000))
    return simulate(config, seed=3, drive=drive, sections=stretch)


RUNS: Mapping[str, WorkedRun[FibreConfig]] = {
    "fibre-no-end-of-section": WorkedRun(
        "The amplitude stays changed for longer than any section: the machine gives up its count, and the "
        "position stays unknown.",
        _endless,
    ),
    "fibre-section-without-end": WorkedRun(
        "A known section does not end where the map has its end: the machine raises error signal F and reports "
        "no place.",
        _endless_where_located,
    ),
}
"""The recordings that ship, by name."""


if __name__ == "__main__":
    write_named(__file__, RUNS, {}, FibreConfig())
