"""The catalogue entry of the machine of one end of a train in a fibre."""

from __future__ import annotations

from collections.abc import Mapping, Sequence
from functools import partial

from safeloc.models import fibre
from safeloc.models.fibre import CoupledConfig, FibreConfig
from safeloc.models.fibre.configurations import CONFIGURATIONS, COUPLED
from safeloc.models.fibre.picture import picture
from safeloc.properties import fibre as claims
from safeloc.properties.fibre import coupled as coupled_claims
from safeloc.reported import Reported
from safeloc.runtime.streams.steps import Cell
from safeloc.target import Entry, Family, Hazard, Pair, Target, single


def target(config: FibreConfig) -> Target:
    """Make the machine."""
    model = fibre.build(fibre.parts(config))
    properties, simulate = claims.properties(model), partial(_simulated, config)
    return single(model.machine, properties, config, reported=Reported(), simulate=simulate, pictures=(picture(),))


def coupled(config: CoupledConfig) -> Target:
    """Make the machine in the world of coupling and material."""
    model = fibre.build_coupled(fibre.parts(config), config)
    return single(model.machine, coupled_claims.properties(model), config, simulate=partial(_coupled_run, config))


def _coupled_run(config: CoupledConfig, seed: int) -> Sequence[Mapping[str, Cell]]:
    from safeloc.models.fibre.coupled_runs import simulate  # numpy is loaded only where something is simulated

    return simulate(config, seed=seed)


def _simulated(config: FibreConfig, seed: int) -> Sequence[Mapping[str, Cell]]:
    from safeloc.models.fibre.simulate import simulate  # numpy is loaded only where something is simulated

    return simulate(config, seed=seed)


ENTRIES = (
    Entry(
        "fibre",
        "place from localization sections in a fibre",
        FibreConfig,
        target,
        Family.FIBRE,
        place=10,
        simulates=True,
        pairs=(
            Pair("rate beside floor", "floor_mm:down", "rate_ppm:up"),
            Pair("floor beside rate", "rate_ppm:down", "floor_mm:up"),
            Pair("line speed beside cycle time", "period_ms:down", "max_speed_mm_s:up"),
            Pair("rate beside places of edges", "edge_tolerance_mm:down", "rate_ppm:up"),
            Pair("change of a section beside normal scatter", "return_cdb:down", "change_cdb:up"),
        ),
        configurations=CONFIGURATIONS,
    ),
    Entry(
        "fibre_coupled",
        "the same, by coupling and material of its sections",
        CoupledConfig,
        coupled,
        Family.FIBRE,
        place=12,
        simulates=True,
        pairs=(
            Pair("coupling by rods beside unevenness", "coupling_gain_cdb:down", "unevenness_cdb:up"),
            Pair("coupling by dampers beside unevenness", "damper_loss_cdb:down", "unevenness_cdb:up"),
            Pair("material beside its spread", "material_gain_cdb:down", "material_spread_cdb:up"),
            Pair("change of a section beside error of a reading", "change_cdb:up", "reading_error_cdb:up"),
            Pair("normal scatter beside unevenness", "return_cdb:down", "unevenness_cdb:up"),
        ),
        configurations=COUPLED,
        no_interval="Its world speaks of the amplitude alone; the interval of the same machine is that of `fibre`.",
        hazard=Hazard(
            "a section is entered without a signal, or a signal comes beside the sections",
            (
                "a section that is entered makes a signal",
                "no signal without a section",
            ),
        ),
    ),
)
