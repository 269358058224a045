"""Fibre sensing, what verifies it, and the virtual sections that it clears."""

from __future__ import annotations

from collections.abc import Mapping, Sequence
from dataclasses import replace
from functools import partial

from pydantic import BaseModel

from safeloc.models import (
    axle_counter,
    axle_head,
    axle_section,
    emitter,
    fibre,
    fibre_area,
    fibre_handover,
    sections,
    train_order,
    verification,
)
from safeloc.models.axle_counter import configurations as axle_counter_configurations
from safeloc.models.axle_counter import simulate as axle_counter_streams
from safeloc.models.axle_head import simulate as axle_head_streams
from safeloc.models.axle_section import simulate as axle_section_streams
from safeloc.models.emitter import configurations as emitter_configurations
from safeloc.models.emitter import simulate as emitter_streams
from safeloc.models.fibre import configurations as fibre_configurations
from safeloc.models.fibre import picture as fibre_picture
from safeloc.models.fibre_area import configurations as fibre_area_configurations
from safeloc.models.sections import configurations as sections_configurations
from safeloc.models.train_order import simulate as train_order_streams
from safeloc.models.verification import configurations as verification_configurations
from safeloc.properties import axle_counter as counter_properties
from safeloc.properties import axle_head as head_properties
from safeloc.properties import axle_section as axle_section_properties
from safeloc.properties import emitter as emitter_properties
from safeloc.properties import fibre as fibre_properties
from safeloc.properties import fibre_area as fibre_area_properties
from safeloc.properties import fibre_handover as handover_properties
from safeloc.properties import sections as sections_properties
from safeloc.properties import train_order as order_properties
from safeloc.properties import verification as verification_properties
from safeloc.reported import Reported
from safeloc.runtime.streams.steps import Cell
from safeloc.shipped.making import recorded, single
from safeloc.target import Entry, Target


def _fibre(config: BaseModel) -> Target:
    assert isinstance(config, fibre.FibreConfig)
    model = fibre.build(fibre.parts(config))
    made = single(model.machine, fibre_properties.properties(model), config)
    simulated = partial(_fibre_simulated, config)
    return replace(made, reported=Reported(), simulate=simulated, pictures=(fibre_picture.picture(),))


def _fibre_simulated(config: fibre.FibreConfig, seed: int) -> Sequence[Mapping[str, Cell]]:
    from safeloc.models.fibre.simulate import simulate  # numpy is loaded only where something is simulated

    return simulate(config, seed=seed)


def _verification(config: BaseModel) -> Target:
    assert isinstance(config, verification.VerificationConfig)
    model = verification.build(verification.parts(config))
    made = single(model.machine, verification_properties.properties(model), config)
    return replace(
        made, reported=Reported(valid="trusted"), simulate=lambda seed: _verification_simulated(config, seed)
    )


def _verification_doubted(config: BaseModel) -> Target:
    """Its recordings show intervals that miss the truth unnoticed: no interval of it is claimed to hold it, only `place_doubt_mm`."""
    assert isinstance(config, verification.VerificationConfig)
    model = verification.build_doubted(verification.parts(config))
    return single(model.machine, verification_properties.properties(model), config)


def _verification_simulated(config: verification.VerificationConfig, seed: int) -> Sequence[Mapping[str, Cell]]:
    from safeloc.models.fibre.simulate import simulate_stay  # numpy is loaded only where something is simulated

    return simulate_stay(config, seed=seed)


def _axle_head(config: BaseModel) -> Target:
    assert isinstance(config, axle_head.AxleHeadConfig)
    model = axle_head.build(axle_head.parts(config))
    made = single(model.machine, head_properties.properties(model), config)
    return replace(made, simulate=lambda seed: axle_head_streams.simulate(config, seed=seed))


def _axle_counter(config: BaseModel) -> Target:
    assert isinstance(config, axle_counter.AxleCounterConfig)
    model = axle_counter.build(axle_counter.parts(config))
    made = single(model.machine, counter_properties.properties(model), config)
    return replace(made, simulate=lambda seed: axle_counter_streams.simulate(config, seed=seed))


def _axle_section(config: BaseModel) -> Target:
    assert isinstance(config, axle_section.AxleSectionConfig)
    model = axle_section.build(axle_section.parts(config))
    made = single(model.machine, axle_section_properties.properties(model), config)
    return replace(made, simulate=lambda seed: axle_section_streams.simulate(config, seed=seed))


def _train_order(config: BaseModel) -> Target:
    assert isinstance(config, train_order.TrainOrderConfig)
    model = train_order.build(train_order.parts(config))
    made = single(model.machine, order_properties.properties(model), config)
    pictures = (fibre_picture.order_picture(),)
    return replace(made, simulate=lambda seed: train_order_streams.simulate(config, seed=seed), pictures=pictures)


def _emitter(config: BaseModel) -> Target:
    assert isinstance(config, emitter.EmitterConfig)
    model = emitter.build(emitter.parts(config))
    made = single(model.machine, emitter_properties.properties(model), config)
    return replace(made, simulate=lambda seed: emitter_streams.simulate(config, seed=seed))


def _sections(config: BaseModel) -> Target:
    assert isinstance(config, sections.SectionsConfig)
    whole = sections.compose_machines(config)
    machines = (whole.area.machine, *(one.machine for one in whole.sections))
    properties = tuple(sections_properties.properties(whole))
    doc = "Trains of a line area between axle counters, and the virtual sections that it is cut into, in one step."
    system = whole.composition.system
    return Target("sections", machines, system, properties, config, doc, recorded("sections"))


def _fibre_area(config: BaseModel) -> Target:
    assert isinstance(config, fibre_area.FibreAreaConfig)
    whole = fibre_area.compose_machines(config)
    system = whole.composition.system
    doc = (
        "A train in a line area, from backscatter to virtual sections in one step: both ends' fibre machines, the test "
        "emitter, the entry record, the verification, what is believed of the ends, the area and its sections."
    )
    reported = Reported(
        position="verification.position_mm",
        below="verification.margin_below_mm",
        above="verification.margin_above_mm",
        valid="verification.trusted",
        truth="front.truth_nm",
    )
    return Target(
        "fibre_area",
        system.machines,
        system,
        tuple(fibre_area_properties.properties(whole)),
        config,
        doc,
        recorded("fibre_area"),
        reported,
        pictures=(fibre_picture.area_picture(config.sections.sections),),
    )


def _fibre_handover(config: BaseModel) -> Target:
    assert isinstance(config, fibre_handover.FibreHandoverConfig)
    whole = fibre_handover.compose_machines(config)
    system, found = whole.composition.system, tuple(handover_properties.properties(whole))
    doc = "A train between two neighbouring areas: two verifications, the record that goes over, and whose position counts."
    reported = Reported(
        position="speaker.position_mm",
        below="speaker.margin_below_mm",
        above="speaker.margin_above_mm",
        valid="speaker.given",
        truth="giving.truth_nm",
    )
    return Target("fibre_handover", system.machines, system, found, config, doc, recorded("fibre_handover"), reported)


ENTRIES = (
    Entry(
        "fibre",
        "place from localization sections in a fibre",
        fibre.FibreConfig,
        _fibre,
        fibre_configurations.CONFIGURATIONS,
    ),
    Entry(
        "verification",
        "a train's fibre position, verified against an axle counter",
        verification.VerificationConfig,
        _verification,
        verification_configurations.CONFIGURATIONS,
    ),
    Entry(
        "verification_doubted",
        "the same where the fibre may be wrong in everything",
        verification.VerificationConfig,
        _verification_doubted,
    ),
    Entry("axle_head", "axles and direction from two overlapping pulses", axle_head.AxleHeadConfig, _axle_head),
    Entry(
        "axle_counter",
        "a train's entry record from its axles",
        axle_counter.AxleCounterConfig,
        _axle_counter,
        axle_counter_configurations.CONFIGURATIONS,
    ),
    Entry(
        "axle_section",
        "clear or occupied by axles counted in and out",
        axle_section.AxleSectionConfig,
        _axle_section,
    ),
    Entry("train_order", "whose a pattern is, by order on the track", train_order.TrainOrderConfig, _train_order),
    Entry(
        "emitter",
        "function check of the fibre by a test emitter",
        emitter.EmitterConfig,
        _emitter,
        emitter_configurations.CONFIGURATIONS,
    ),
    Entry(
        "fibre_area",
        "a train and its area in one step",
        fibre_area.FibreAreaConfig,
        _fibre_area,
        fibre_area_configurations.CONFIGURATIONS,
    ),
    Entry(
        "fibre_handover",
        "a train between two neighbouring areas",
        fibre_handover.FibreHandoverConfig,
        _fibre_handover,
    ),
    Entry(
        "sections",
        "clear or not: virtual sections of a line area",
        sections.SectionsConfig,
        _sections,
        sections_configurations.CONFIGURATIONS,
    ),
)
