"""Properties of coupling and material: which sections change the amplitude, and make the position signal (FWG-2, FWG-3, FWG-12, FWG-13)."""

from __future__ import annotations

from collections.abc import Iterator
from functools import partial

from safeloc.language.expr import any_of, before
from safeloc.language.spec import Property, always, reachable
from safeloc.models.fibre import Fibre
from safeloc.models.fibre import variables as v
from safeloc.models.fibre.coupled import (
    BESIDE,
    COUPLED,
    DAMPED,
    LESS_SENSITIVE,
    MORE_SENSITIVE,
    Coupling,
)
from safeloc.properties.fibre.counting import tells_changes

REQUIREMENTS = ("FWG-1", "FWG-2", "FWG-3", "FWG-12", "FWG-13")
LAW = "by how much coupling and material of a section change the amplitude, and how even it is beside the sections"
under_assumption = partial(always, requirements=REQUIREMENTS, assumption=LAW)


def properties(model: Fibre) -> list[Property]:
    """Return the properties, each in the world of coupling and material."""
    if model.coupling is None:
        raise TypeError("these claims speak of the world of coupling and material: hand in what build_coupled returns.")
    fibre = model.coupling
    return [
        *_changed(model, fibre),
        *_beside(model, fibre),
        *_signal(model, fibre),
        *_once(model, fibre),
        *_reached(model, fibre),
    ]


def _changed(model: Fibre, fibre: Coupling) -> Iterator[Property]:
    """Claim the amplitude's band from the section in which it is received."""
    own, last, received = model.own, fibre.last_received, model.own.amplitude.present
    yield under_assumption(
        "coupling to the rail and a more sensitive guide raise",
        (received & last.one_of(COUPLED, MORE_SENSITIVE) & before(own.band).ne(v.LOWERED)).implies(
            own.band.eq(v.RAISED)
        ),
        statement="where the fibre is coupled to the rail, or is of a more sensitive guide, the amplitude is raised in every cycle in which it is "
        "received; unless it was lowered before, and is normal for one cycle in between",
    )
    yield under_assumption(
        "dampers and a less sensitive guide lower",
        (received & last.one_of(DAMPED, LESS_SENSITIVE) & before(own.band).ne(v.RAISED)).implies(
            own.band.eq(v.LOWERED)
        ),
        statement="where the fibre has dampers, or is of a less sensitive guide, the amplitude is lowered in every cycle in which it is received; "
        "unless it was raised before, and is normal for one cycle in between",
    )


def _beside(model: Fibre, fibre: Coupling) -> Iterator[Property]:
    """Claim that fibre beside the sections changes nothing, and ends what was reported of one."""
    yield under_assumption(
        "beside the sections the amplitude is normal",
        fibre.last_received.eq(BESIDE).implies(model.own.band.eq(v.NORMAL) & ~model.machine.flag("in_section")),
        statement="where the fibre lies beside all sections no section is reported, and what was reported of one ends with the first amplitude there",
    )


def _signal(model: Fibre, fibre: Coupling) -> Iterator[Property]:
    """Claim the position signal from the section, both ways."""
    own, last = model.own, fibre.last_received
    section = last.one_of(COUPLED, MORE_SENSITIVE, DAMPED, LESS_SENSITIVE)
    signal = own.event.eq(v.POSITION_SIGNAL)
    entered = before(last).eq(BESIDE) & section & own.amplitude.present
    yield under_assumption(
        "a section that is entered makes a signal",
        (entered & tells_changes(model)).implies(signal),
        statement="whenever the amplitude was received beside the sections last, and is received in a section now, a position signal arises in this "
        "cycle, by whichever of the four makings; while the machine follows the pattern and no reference comes",
    )
    yield under_assumption(
        "no signal without a section",
        signal.implies(last.ne(BESIDE) & own.amplitude.present),
        statement="a position signal arises only with an amplitude that is received in a section, at an edge, or at a false change; never beside the sections",
    )


def _once(model: Fibre, fibre: Coupling) -> Iterator[Property]:
    """Claim that a section makes one signal and no more."""
    own, last, signal = model.own, fibre.last_received, model.own.event.eq(v.POSITION_SIGNAL)
    pairs = ((COUPLED, MORE_SENSITIVE), (DAMPED, LESS_SENSITIVE))
    stays = any_of(before(last).one_of(*pair) & last.one_of(*pair) for pair in pairs)
    yield under_assumption(
        "a section makes one signal",
        (stays & before(own.band).ne(v.NORMAL)).implies(~signal & own.band.eq(before(own.band))),
        statement="while the end stays in a section whose signal came, no further one comes, and the section is reported until the end leaves it",
    )


def _reached(model: Fibre, fibre: Coupling) -> Iterator[Property]:
    names = {
        "coupled to the rail": COUPLED,
        "with dampers": DAMPED,
        "of a more sensitive guide": MORE_SENSITIVE,
        "of a less sensitive guide": LESS_SENSITIVE,
    }
    for name, made in names.items():
        yield reachable(
            f"a signal of a section {name}",
            model.own.event.eq(v.POSITION_SIGNAL) & fibre.last_received.eq(made),
            statement=f"a section {name} can make a position signal",
            requirements=REQUIREMENTS,
        )
