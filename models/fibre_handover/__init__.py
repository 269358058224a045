"""A train between two neighbouring areas, each with its own verification, in one step (FVA-D1; figures, 003 item 14).

    giving  the verification of the area from which the train comes         models.verification
    border  the record that goes over, or is lost                             fibre_handover.border
    taking  the verification of the area into which the train runs          models.verification
    speaker the choice of the area that reports the position                  fibre_handover.speaker

The taking area has no axle counter at the border: its reference is the record against which the giving area verified,
sent while that area trusts the train. A record that does not arrive is a reference that was due and did not come. The train may run
either way: if it runs down, the giving area lies above.

Inputs of a cycle: all of models.verification for `giving` and for `taking`, but for the latter's record (count, length and
place), its being due and its sender, which are wired; `border.record_arrives`, `border.train_gone`, `border.train_runs_down`.
Outputs: `speaker.given`, `.position_mm`, `.margin_above_mm`, `.margin_below_mm`, and those of the other machines by their names.
"""

from __future__ import annotations

from dataclasses import dataclass

from pydantic import model_validator

from safeloc.config import Config
from safeloc.language.composition import Composition, compose
from safeloc.language.expr import Expr, Num, Var
from safeloc.models.fibre_handover.border import Border, BorderConfig
from safeloc.models.fibre_handover.border import build as build_border
from safeloc.models.fibre_handover.border import parts as border_parts
from safeloc.models.fibre_handover.speaker import Speaker, speaker
from safeloc.models.verification import Verification, VerificationConfig, build, parts
from safeloc.models.vocabulary.absent import wired_interval


class FibreHandoverConfig(Config):
    """Figures of the hand-over; both areas verify by the same tolerances."""

    verification: VerificationConfig = VerificationConfig()
    border: BorderConfig = BorderConfig()

    @model_validator(mode="after")
    def _one_line(self) -> FibreHandoverConfig:
        places = (self.verification.position_limit_mm, self.border.position_limit_mm)
        if places[0] > places[1]:
            raise ValueError(
                f"verification.position_limit_mm ({places[0]}) has to be no greater than border.position_limit_mm "
                f"({places[1]})."
            )
        return self


@dataclass(frozen=True, eq=False)
class FibreHandover:
    """The machines, and their composition."""

    config: FibreHandoverConfig
    giving: Verification
    border: Border
    taking: Verification
    speaker: Speaker
    composition: Composition


def interval(verified: Verification) -> tuple[Num, Num]:
    """Return bounds of the front, as a verification reports them."""
    position, below, above = wired_interval(verified.machine)
    return position - below, position + above


def compose_machines(config: FibreHandoverConfig | None = None) -> FibreHandover:
    """Return both verifications with the border between them."""
    config = config or FibreHandoverConfig()
    giving, taking = (build(parts(config.verification), name=name) for name in ("giving", "taking"))
    far = config.border.position_limit_mm + config.verification.margin_limit_mm
    return joined(config, giving, build_border(border_parts(config.border, far)), taking, speaker(far))


def joined(
    config: FibreHandoverConfig, giving: Verification, between: Border, taking: Verification, voice: Speaker
) -> FibreHandover:
    """Return the given machines, wired. Both verifications concern one and the same train."""
    wires: dict[Var, Expr] = {
        between.own.giving_trusts: giving.machine.flag("trusted"),
        between.own.giving_distrusts: giving.machine.flag("untrusted"),
        between.own.low: interval(giving)[0],
        between.own.high: interval(giving)[1],
        **_taking_wires(giving, between, taking),
        voice.shared_from: between.own.shared_from,
        voice.shared_to: between.own.shared_to,
        voice.downwards: between.own.runs_down,
    }
    for side, verified in ((voice.giving, giving), (voice.taking, taking)):
        low, high = interval(verified)
        wires |= {side.trusts: verified.machine.flag("trusted"), side.low: low, side.high: high}
    machines = [giving.machine, between.machine, taking.machine, voice.machine]
    return FibreHandover(config, giving, between, taking, voice, compose("fibre_handover", machines, wires))


def _taking_wires(giving: Verification, between: Border, taking: Verification) -> dict[Var, Expr]:
    """Return the wires of the taking area: its reference is the record that the giving area still trusts; ghosts: the same train."""
    own, giver = taking.own, giving.machine
    return {
        own.due: between.own.due,
        own.reference_from: between.own.source,
        own.sound: between.own.sound & giver.flag("handover_trusted"),
        own.record_axles: giver.output("handover_axles"),
        own.record_length_low: giver.output("handover_length_low_mm"),
        own.record_length_high: giver.output("handover_length_high_mm"),
        own.record_place_low: giver.output("handover_place_low_mm"),
        own.record_place_high: giver.output("handover_place_high_mm"),
        own.leaves: between.own.gone,
        own.next_truth: giving.own.truth,
        own.next_axles: giving.own.axles,
        own.next_length: giving.own.length,
    }
