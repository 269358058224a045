"""The catalogue entry of a link that passes positions on."""

from __future__ import annotations

from safeloc.models import transmission
from safeloc.models.transmission import TransmissionConfig
from safeloc.models.transmission.configurations import CONFIGURATIONS
from safeloc.properties import transmission as claims
from safeloc.reported import Reported
from safeloc.target import Entry, Family, Pair, Target, single


def target(config: TransmissionConfig) -> Target:
    """Make the machine."""
    model = transmission.build(transmission.parts(config))
    return single(model.machine, claims.properties(model), config, reported=Reported())


ENTRIES = (
    Entry(
        "transmission",
        "a position on its way; its age widens it",
        TransmissionConfig,
        target,
        Family.LOCALIZER,
        place=20,
        configurations=CONFIGURATIONS,
        silent=("transmission",),
        pairs=(
            Pair("period beside line speed", "max_speed_mm_s:down", "period_ms:up"),
            Pair("line speed beside period", "period_ms:down", "max_speed_mm_s:up"),
            Pair("age beside line speed", "max_speed_mm_s:down", "age_limit_ms:up", "design"),
            Pair("width beside age", "age_limit_ms:down", "margin_limit_mm:up", "design"),
            Pair("length of the line beside width", "margin_limit_mm:down", "position_limit_mm:up", "design"),
        ),
    ),
)
