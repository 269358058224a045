"""The world of coupling and material: by how much a section changes the amplitude that is received (FWG-2, FWG-3, FWG-12, FWG-13).

    made         how the fibre lies at the end of the train: beside all sections; in a section that is coupled to the rail by rods, tubes
                 or spikes, decoupled by dampers, or of a more or a less sensitive guide; or elsewhere (an edge, a false change)
    vibration    the vehicle's vibration that reaches the fibre there, over that beside the sections: a matter of coupling
    sensitivity  the guide's answer to a vibration there, over that beside the sections: a matter of material
    amplitude    what is received: both together

The machine is that of `models.fibre`. There, any section may be missed, and the proof of the place needs no law of coupling. Here
the laws say when a section cannot be missed; nothing is assumed of runs, maps, references or code words.
"""

from __future__ import annotations

from dataclasses import dataclass

from pydantic import model_validator

from safeloc.config import quantity
from safeloc.language.expr import Bool, Num, NumVar, all_of, between, choice, enumeration, ite, members, number
from safeloc.language.world import Law, World
from safeloc.models.fibre.variables import CDB, FibreConfig, Parts

_MADE = members("section_made", "BESIDE", "COUPLED", "DAMPED", "MORE_SENSITIVE", "LESS_SENSITIVE", "ELSEWHERE")
BESIDE, COUPLED, DAMPED, MORE_SENSITIVE, LESS_SENSITIVE, ELSEWHERE = _MADE
_MOST_CDB = 20_000


class CoupledConfig(FibreConfig):
    """The machine's figures, and those of coupling and material."""

    coupling_gain_cdb: int = quantity(
        1_200, "cdB", 1, 6_000, "[D] least rise by rods, tubes or spikes; simulated with 18 dB"
    )
    damper_loss_cdb: int = quantity(1_200, "cdB", 1, 6_000, "[D] least fall by dampers; simulated with 12 dB")
    material_gain_cdb: int = quantity(
        1_200, "cdB", 1, 6_000, "[D] least rise by a more sensitive guide; simulated: 18 dB"
    )
    material_loss_cdb: int = quantity(
        1_200, "cdB", 1, 6_000, "[D] least fall by a less sensitive guide; simulated: 12 dB"
    )
    unevenness_cdb: int = quantity(
        300, "cdB", 0, 4_000, "[M] coupling of one place to another, over the window: 1.5 of 2 dB"
    )
    material_spread_cdb: int = quantity(50, "cdB", 0, 4_000, "[M] one guide, from drum to drum")
    reading_error_cdb: int = quantity(50, "cdB", 0, 4_000, "[M] noise of light, over the window of the amplitude")

    @model_validator(mode="after")
    def _noticed(self) -> CoupledConfig:
        spread = self.unevenness_cdb + self.material_spread_cdb + self.reading_error_cdb
        if spread > self.return_cdb:
            raise ValueError(
                f"unevenness, spread and error come to {spread} cdB, but only {self.return_cdb} (return_cdb) are normal: the fibre "
                "beside the sections would look like one; lay it more evenly, or raise return_cdb."
            )
        for name in ("coupling_gain_cdb", "damper_loss_cdb", "material_gain_cdb", "material_loss_cdb"):
            if getattr(self, name) - spread < self.change_cdb:
                raise ValueError(
                    f"{name} ({getattr(self, name)}) less unevenness, spread and error ({spread}) lies below change_cdb "
                    f"({self.change_cdb}): such a section could be missed; couple it better, or lower change_cdb."
                )
        return self


@dataclass(frozen=True, eq=False)
class Coupling:
    """Ghosts and choices of the world.

    last_received  how the fibre lay where the amplitude was last received; at first as beside the sections
    made, vibration, sensitivity   freely chosen within the laws: of the place at the end of the cycle
    """

    own: Parts
    config: CoupledConfig
    last_received: NumVar
    made: NumVar
    vibration: NumVar
    sensitivity: NumVar


def coupling(own: Parts, config: CoupledConfig) -> Coupling:
    """Return fresh ghosts beside the machine's parts."""
    kinds = enumeration(_MADE)
    return Coupling(
        own,
        config,
        choice("section_last_received", kinds),
        choice("next_section_made", kinds),
        number("vibration_cdb", CDB, -_MOST_CDB, _MOST_CDB),
        number("sensitivity_cdb", CDB, -_MOST_CDB, _MOST_CDB),
    )


def coupled_world(fibre: Coupling) -> World:
    """Return the world: no clause reads runs, the map, references or code words."""
    return World(
        ghosts={fibre.last_received: BESIDE},
        choices=[fibre.made, fibre.vibration, fibre.sensitivity],
        moves={fibre.last_received: ite(fibre.own.amplitude.present, fibre.made, fibre.last_received)},
        clauses={
            "coupling decides how much vibration reaches the fibre": _coupling_law(fibre),
            "material decides how the guide answers to it": _material_law(fibre),
            "the amplitude is vibration and answer together": _amplitude_law(fibre),
        },
    )


def _coupling_law(fibre: Coupling) -> Law:
    config, reaches, uneven = fibre.config, fibre.vibration, fibre.config.unevenness_cdb
    elsewhere = fibre.made.eq(ELSEWHERE)
    return Law(
        all_of(
            [
                fibre.made.eq(COUPLED).implies(reaches >= config.coupling_gain_cdb - uneven),
                fibre.made.eq(DAMPED).implies(reaches <= uneven - config.damper_loss_cdb),
                elsewhere | fibre.made.one_of(COUPLED, DAMPED) | between(-uneven, reaches, uneven),
            ]
        ),
        "Of the vehicle's vibration, a section that is coupled to the rail by rods, tubes or spikes lets at least its gain more reach the "
        "fibre than the ground beside the sections does, and a section with dampers at least its loss less; anywhere but at edges "
        "and false changes it is as much as beside, each within the unevenness of the ground.",
        ("coupling_gain_cdb", "damper_loss_cdb", "unevenness_cdb"),
        "[S] 002 l. 78, 145, 203, 213: rods, tubes, spikes; dampers; [M] unevenness",
        "infrastructure",
        "amplitude of trains in and beside each section, when it is made and at each passage",
    )


def _material_law(fibre: Coupling) -> Law:
    config, answer, spread = fibre.config, fibre.sensitivity, fibre.config.material_spread_cdb
    other = fibre.made.one_of(MORE_SENSITIVE, LESS_SENSITIVE, ELSEWHERE)
    return Law(
        all_of(
            [
                fibre.made.eq(MORE_SENSITIVE).implies(answer >= config.material_gain_cdb - spread),
                fibre.made.eq(LESS_SENSITIVE).implies(answer <= spread - config.material_loss_cdb),
                other | between(-spread, answer, spread),
            ]
        ),
        "A section of a more sensitive guide answers to a vibration by at least its gain more than the guide beside it, one of a less "
        "sensitive guide by at least its loss less; all other fibre answers alike, within the guide's spread.",
        ("material_gain_cdb", "material_loss_cdb", "material_spread_cdb"),
        "[S] 002 l. 80, 145, 203: guide of another sensitivity; [M] spread",
        "supplier",
        "type test of both guides on one shaker; amplitude of trains at each passage",
    )


def _amplitude_law(fibre: Coupling) -> Law:
    off, error = fibre.own.amplitude.value - _together(fibre), fibre.config.reading_error_cdb
    return Law(
        fibre.own.amplitude.present.implies(between(-error, off, error)),
        "The amplitude that is received, over its normal, is what the coupling lets reach the fibre and what the guide makes of it, "
        "within the error of the reading; the vehicle's own loudness moves with it and is part of the normal.",
        ("reading_error_cdb",),
        "[M] light of 50 dB over its noise, mean of a window",
        "supplier",
        "type test with a shaker of known strength",
    )


def _together(fibre: Coupling) -> Num:
    return fibre.vibration + fibre.sensitivity


def raises(made: Num) -> Bool:
    """Return the condition that such a section raises the amplitude."""
    return made.eq(COUPLED) | made.eq(MORE_SENSITIVE)


def lowers(made: Num) -> Bool:
    """Return the condition that such a section lowers the amplitude."""
    return made.eq(DAMPED) | made.eq(LESS_SENSITIVE)
