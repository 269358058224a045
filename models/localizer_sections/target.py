"""The catalogue entry of a vehicle that locates itself, and the virtual sections that it runs through."""

from __future__ import annotations

from safeloc.models import localizer_sections
from safeloc.models.localizer.picture import PASSED_ON, picture
from safeloc.models.localizer.target import SECTIONS, properties_of_machines
from safeloc.models.localizer_sections import NAME, LocalizerSectionsConfig
from safeloc.models.localizer_sections.configurations import CONFIGURATIONS
from safeloc.properties import localizer_sections as claims
from safeloc.target import Entry, Family, Hazard, Target, recorded

DOC = (
    "A vehicle that locates itself, and the virtual sections that it runs through, in one step. The vehicle sends its "
    "position by radio to the line area, which follows the train and adds the report's age to the error."
)


def target(config: LocalizerSectionsConfig) -> Target:
    """Make the composition."""
    model = localizer_sections.compose_machines(config)
    properties, system = tuple(claims.properties(model)), model.composition.system
    return Target(
        NAME, system.machines, system, properties, config, DOC, recorded(NAME), PASSED_ON,
        pictures=(picture(config.localizer, _says),), members=properties_of_machines(model.localizer),
        sections={**SECTIONS, "ends": "train", "far_uplink": "uplink"},
    )  # fmt: skip


def _says(recording: str) -> str:
    """Return the expected outcome of a shipped recording; empty for any other."""
    from safeloc.models.localizer_sections.simulate import SCENES  # numpy is loaded only where a picture is drawn

    scene = SCENES.get(recording.removeprefix(f"{NAME}-"))
    return scene.says if scene else ""


ENTRIES = (
    Entry(
        NAME,
        "the located train in virtual sections: one truth on board and trackside",
        LocalizerSectionsConfig,
        target,
        Family.LOCALIZER,
        place=40,
        members=(
            "motion",
            "balise",
            "verification",
            "downlink",
            "arbitration",
            "delocalized",
            "uplink",
            "ends",
            "far_uplink",
            "trackside",
            "area",
            "section_1",
        ),
        pairs_of=("balise", "verification", "sections"),
        configurations=CONFIGURATIONS,
        hazard=Hazard(
            "a section is reported clear with a vehicle in it",
            (
                "section_* is never clear with a train in it",
                "section_* is never clear with a vehicle that was not counted",
                "section_* is never clear with this train in it",
            ),
        ),
    ),
)
