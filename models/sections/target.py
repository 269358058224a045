"""The catalogue entry of a line area with its virtual sections."""

from __future__ import annotations

from pathlib import Path

from safeloc.models import sections
from safeloc.models.sections import SectionsConfig
from safeloc.models.sections.configurations import CONFIGURATIONS
from safeloc.properties import sections as claims
from safeloc.target import Entry, Family, Hazard, Pair, Target, recorded

DOC = "Trains of a line area between axle counters, and the virtual sections that it is cut into, in one step."


def target(config: SectionsConfig) -> Target:
    """Make the composition of the area and its sections."""
    model = sections.compose_machines(config)
    machines = (model.area.machine, *(one.machine for one in model.sections))
    properties, system = (*claims.properties(model), *claims.of_each_machine(model)), model.composition.system
    return Target("sections", machines, system, properties, config, DOC, _recordings(config))


def _recordings(config: SectionsConfig) -> tuple[Path, ...]:
    """Return the recordings that ship, if the configuration has their inputs: trains, sections, borders and inner detection as recorded."""
    kind, default = _inputs(config), _inputs(SectionsConfig())
    return recorded("sections") if kind == default else ()


def _inputs(config: SectionsConfig) -> tuple[object, ...]:
    """Return the figures on which the inputs depend."""
    area = config.area
    return area.trains, area.borders, area.inner_detection, config.sections


ENTRIES = (
    Entry(
        "sections",
        "clear or not: virtual sections of a line area",
        SectionsConfig,
        target,
        Family.FIBRE,
        place=110,
        members=("area", "section_1"),
        configurations=CONFIGURATIONS,
        pairs=(
            Pair("age of reports beside cycle time", "area.period_ms:down", "area.report_age_limit_ms:up", "design"),
            Pair("line speed beside cycle time", "area.period_ms:down", "area.max_speed_mm_s:up", "design"),
            Pair(
                "reports at the entry beside cycle time",
                "area.period_ms:down",
                "area.entry_report_delay_ms:up",
                "design",
            ),
            Pair("waiting for a report beside waiting for integrity", "integrity_wait_ms:down", "mute_ms:up", "design"),
            Pair(
                "reaction beside delivery of an authority",
                "following.delivery_ms:down",
                "following.reaction_ms:up",
                "design",
            ),
        ),
        no_interval="It reports which sections are clear.",
        hazard=Hazard(
            "a section is reported clear with a vehicle in it",
            (
                "section_* is never clear with a train in it",
                "section_* is never clear with a vehicle that was not counted",
            ),
        ),
        silent=("area",),
    ),
)
