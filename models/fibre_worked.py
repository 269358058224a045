"""Runs of the fibre machine that the figures of the source do not show, worked out as features."""

from __future__ import annotations

from collections.abc import Mapping

from safeloc.models.fibre_parts.code import Symbol
from safeloc.models.fibre_parts.variables import FibreConfig
from safeloc.models.fibre_streams import Drive, Section, simulate, steady
from safeloc.runs.worked import Steps, WorkedRun


def _endless(config: FibreConfig) -> Steps:
    """Along 2 km where the amplitude stays raised, with nothing known before."""
    stretch = [Section(100_000, 2_100_000, Symbol(rises=True, long=True))]
    return simulate(config, seed=3, drive=Drive(steady(cycles=70), referred=False), sections=stretch)


RUNS: Mapping[str, WorkedRun[FibreConfig]] = {
    "fibre-no-end-of-section": WorkedRun(
        "The amplitude stays changed for longer than any section: what was counted is given up, and nothing is known.",
        _endless,
    ),
}
