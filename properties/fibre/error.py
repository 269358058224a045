"""Properties of the error signal F: when it is raised, and when not (FWG-4 to FWG-9)."""

from __future__ import annotations

from collections.abc import Iterator

from safeloc.language.expr import Bool, Lit, abs_, any_of, before
from safeloc.language.spec import Property, always
from safeloc.models.fibre import CHECKED, CODE, Fibre
from safeloc.models.fibre import variables as v
from safeloc.properties.fibre.seen import Seen
from safeloc.properties.no_interval import no_interval

NAMED: dict[str, tuple[Lit, tuple[str, ...], str]] = {
    "false section raises F at once": (v.FALSE_SECTION, CHECKED, "a change of amplitude where the map has no such section"),
    "missed section raises F at once": (v.MISSED_SECTION, CHECKED, "a section of the map, ahead or behind, that did not come"),
    "wrong length raises F": (v.WRONG_LENGTH, CODE, "a section of another length than the map has, or of none that can be read"),
    "endless section raises F at once": (v.NO_END_OF_SECTION, CHECKED, "a change of amplitude longer than any section"),
    "time of flight raises F at once": (v.FLIGHT_DIFFERS, CHECKED, "another place by time of flight"),
    "reflecting point raises F at once": (v.REFLECTION_DIFFERS, CHECKED, "a reflecting point of another place"),
}  # fmt: skip


def properties(model: Fibre) -> list[Property]:
    """Return the properties: each disagreement raises F, nothing else does, and F is latched."""
    return [*_disagreements(model), *_additional(model), *_latch(model)]


def _disagreements(model: Fibre) -> Iterator[Property]:
    machine, own, seen = model.machine, model.own, Seen(model.own)
    *_, located, faulted = machine.modes
    mode, was_located = machine.mode, before(machine.mode).eq(located)
    compared = was_located & ~(own.reference_accepted & seen.normal) & ~seen.lost
    for name, (reason, trace, what) in NAMED.items():
        yield _held(
            name,
            (compared & seen.flaws[reason]).implies(machine.flag("error") & ~machine.flag("valid") & mode.eq(faulted)),
            f"{what} raises F, and ends the location, in the same cycle",
            trace,
        )
    newly = before(mode).ne(faulted) & mode.eq(faulted)
    causes = any_of(own.why.eq(reason) & cause for reason, cause in seen.flaws.items())
    yield _held(
        "F arises only for the reported reason",
        newly.implies(was_located & causes),
        "F arises only from a disagreement that its reason names, in that cycle, and only if the end was located",
        CHECKED,
    )


def _additional(model: Fibre) -> Iterator[Property]:
    """Claim that F compares the additional localization with the section of the position signal."""
    machine, own, seen = model.machine, model.own, Seen(model.own)
    was_located = before(machine.mode).eq(machine.modes[2])
    signal = was_located & ~own.reference_accepted & own.event.eq(v.POSITION_SIGNAL)
    near = seen.near
    additional = {
        "time of flight": (own.flight_position, own.config.flight_threshold_mm, ("FWG-4", "FWG-6", "FWG-7")),
        "reflecting point": (own.reflecting_point, own.config.reflection_threshold_mm, ("FWG-4", "FWG-5", "FWG-7")),
    }
    for name, (measured, threshold, trace) in additional.items():
        far = measured.present & (abs_(measured.value - near) > threshold)
        yield _held(
            f"{name} off the section raises F",
            (signal & far).implies(machine.flag("error")),
            f"if the place by {name} and the section's known place differ by more than the threshold, F is raised "
            "in the cycle of the position signal",
            trace,
        )


def _latch(model: Fibre) -> Iterator[Property]:
    machine, own = model.machine, model.own
    faulted, mode = machine.modes[-1], machine.mode
    yield _held(
        "F is latched",
        (before(mode).eq(faulted) & mode.ne(faulted)).implies(own.reference_accepted),
        "F stays until a reference is accepted",
        CHECKED,
    )
    yield _held(
        "F reports nothing",
        machine.flag("error").implies(no_interval(machine) & ~machine.flag("count_known")),
        "while F is raised there is neither place nor count",
        CHECKED,
    )
    yield _held(
        "F has a reason",
        machine.flag("error").implies(own.why.one_of(*(reason for reason, *_ in NAMED.values()))),
        "F says why",
        CHECKED,
    )


def _held(name: str, term: Bool, statement: str, trace: tuple[str, ...]) -> Property:
    return always(name, term, statement=statement, requirements=trace, unconditional=True)
