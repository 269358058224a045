"""Drawing of a run of the localizer: each source's interval about the truth, the leading source, and every rejected input."""

from __future__ import annotations

from collections.abc import Callable, Iterator, Sequence

from safeloc.models.delocalized.reported import interval_of_the_host
from safeloc.models.localizer import LocalizerConfig
from safeloc.railway.pictures import NamedInterval, Refusals, Sources, Things
from safeloc.reported import Reported

PASSED_ON = interval_of_the_host()
_ODOMETERS = ("front_wheel", "front_radar", "rear_wheel", "rear_radar")


def picture(config: LocalizerConfig, says: Callable[[str], str]) -> Sources:
    """Return the picture of a localizer with its configured sources; `says` gives the description of a recording."""
    used = config.arbitration.sources
    refusals = [Refusals("odometer", "motion.measured", ("ADMITTED",))]
    refusals += [one for name in used for one in _REFUSALS[name]]
    return Sources(
        "Interval of each source, and the one passed on, around the true front end over time",
        config.motion.period_ms,
        PASSED_ON,
        "arbitration.lead",
        tuple(_interval(name) for name in used),
        tuple(_beside(used)),
        (*refusals, *_of_the_composition()),
        says,
    )


def _beside(used: Sequence[str]) -> Iterator[Things]:
    """Yield what stands beside the line; with balises the map's next reflector is an input of the line."""
    for name in used:
        if name == "reflector" and "balise" in used:
            yield Things("reflector", "line.next_position_mm", "reflector.next_model")
        elif name in _BESIDE:
            yield _BESIDE[name]


def _interval(name: str) -> NamedInterval:
    """Return the outputs that a source states to arbitration: of the fibre, those that have arrived on board."""
    machine = {"satellite": "position", "fibre": "downlink"}.get(name, name)
    position, below, above, valid = (
        f"{machine}.{what}" for what in ("position_mm", "margin_below_mm", "margin_above_mm", "valid")
    )
    return NamedInterval(name, Reported(position, below, above, valid))


def _of_the_composition() -> Iterator[Refusals]:
    excluding = ("arbitration.contradicting_first", "arbitration.contradicting_second")
    yield Refusals("passed on", "arbitration.reason", ("NONE",), excluding)


# A fibre's cycle without a block is NOT_ASSOCIATED; that nothing comes for longer shows in downlink.mode.
_REFUSALS = {
    "odometry": (
        *(Refusals("odometry", f"odometry.{unit}_last_verdict", ("ADMITTED",)) for unit in _ODOMETERS),
        *(Refusals("odometry", f"odometry.{end}_reading", ("NONE", "ACCEPTED", "CANDIDATE")) for end in ("front", "rear")),
        Refusals("odometry", "odometry.reason", ("NONE",)),
    ),
    "balise": (
        Refusals("balise", "balise.telegram", ("NONE", "ACCEPTED", "CANDIDATE")),
        Refusals("balise", "balise.linking", ("NONE", "TAKEN")),
        Refusals("balise", "balise.reaction", ("NONE",)),
        Refusals("balise", "balise.reason", ("NONE",)),
    ),
    "reflector": (Refusals("reflector", "reflector.error", ("NONE",)),),
    "satellite": (
        Refusals("satellite", "position.fix", ("NONE", "ACCEPTED")),
        Refusals("satellite", "position.reason", ("LOCATED",)),
    ),
    "fibre": (
        Refusals("fibre", "verification.reason", ("VERIFIED", "NOT_ASSOCIATED")),
        Refusals("fibre", "downlink.mode", ("HELD",)),
    ),
}  # fmt: skip
_BESIDE = {
    "odometry": Things("marker", "odometry.front_marker_position_mm", "odometry.front_marker"),
    "balise": Things("balise", "balise.telegram_position_mm", "balise.telegram_group"),
    "reflector": Things("reflector", "reflector.next_position_mm", "reflector.next_model"),
}
