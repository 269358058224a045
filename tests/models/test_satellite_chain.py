"""The whole chain, epoch by epoch (SAT-6): driven along simulated and recorded skies, and what it does with what is wrong."""

from __future__ import annotations

import math
from collections.abc import Sequence
from dataclasses import replace
from functools import cache

import pytest

from safeloc.language.interpret import run
from safeloc.language.system import without_ghosts
from safeloc.language.verdict import Proved
from safeloc.models.satellite import compose_machines
from safeloc.models.satellite.chain import ChainConfig, Cycle, EpochChain, Outcome, Reference, Run
from safeloc.models.satellite.variables import FIX, MISSING, SatelliteConfig
from safeloc.models.satellite_selection import SelectionConfig
from safeloc.proof.provers.protection import protected
from safeloc.railway.map.routes import through_routes
from safeloc.railway.map.toml_files import find_line
from safeloc.railway.map.topology import Topology
from safeloc.runtime.border import Reason
from safeloc.sensing.satellite.corrected import CorrectedEpoch, CorrectedSky
from safeloc.sensing.satellite.epochs import Epoch, Measured, Row, received
from safeloc.sensing.satellite.figures import LIGHT_M_PER_S
from safeloc.sensing.satellite.line_track import LineTrack
from safeloc.sensing.satellite.navigation import Navigation, read_navigation
from safeloc.sensing.satellite.observations import read_observations
from safeloc.sensing.satellite.orbits import satellite_state
from safeloc.sensing.satellite.places import Place
from safeloc.sensing.satellite.predicted import predicted_of_state
from safeloc.sensing.satellite.track_prediction import Portion
from safeloc.simulation.satellite.almanacs import broadcast_almanac
from safeloc.simulation.satellite.run import SimulatedRun, World, simulate
from tests.data_sources import data_file
from tests.simulation.satellite.sky import ride, sky, straight

SELECTION = SelectionConfig(channels=28)
CONFIG = ChainConfig(satellite=SatelliteConfig(selection=SELECTION), window_epochs=2)
TRACK = straight()
STILL = (0.0, 0.0, 0.0)


@cache
def driven_run() -> SimulatedRun:
    """8 s from standing, five epochs a second."""
    return simulate(World(sky(), TRACK), ride(8.0, 200), seed=3)


def start(sim: SimulatedRun, number: int = 0) -> Reference:
    """A balise under the train in this epoch, with the speed there."""
    truth = sim.truth[number]
    return Reference(round(truth.place_m * 1_000), 1_000, round(truth.speed_m_per_s * 1_000), 100)


def chain(config: ChainConfig = CONFIG, navigation: Navigation | None = None, *tracks: Portion) -> EpochChain:
    """A chain on the straight track under the simulated sky."""
    return EpochChain(config, navigation or sky(), lambda low_m, high_m: tracks or (TRACK,))


def driven(one: EpochChain, epochs: Sequence[Epoch | None], first: Reference) -> list[Outcome]:
    """A reference in the first cycle, then epochs alone."""
    return [one.step(Cycle(epoch, reference=first if n == 0 else None)) for n, epoch in enumerate(epochs)]


@cache
def outcomes() -> tuple[Outcome, ...]:
    """The healthy drive."""
    return tuple(driven(chain(), driven_run().epochs, start(driven_run())))


def fix(outcome: Outcome) -> str:
    """What became of a cycle's solution."""
    return FIX[int(outcome.outputs["position.fix"])].label


def missing(outcome: Outcome) -> str:
    """Why there was none."""
    return MISSING[int(outcome.outputs["position.missing"])].label


def changed(epoch: Epoch, **by_m: float) -> Epoch:
    """Some satellites' pseudoranges longer by so much."""
    return Epoch(epoch.time_s, epoch.satellites | {
        name: Measured(epoch.satellites[name].code() + more, epoch.satellites[name].rate()) for name, more in by_m.items()
    })  # fmt: skip


def test_a_healthy_drive_is_located_throughout() -> None:
    """Every report holds the truth, within the tolerance; from the third epoch on solutions count."""
    for outcome, truth in zip(outcomes(), driven_run().truth, strict=True):
        position, below, above = (
            int(outcome.outputs[f"position.{name}_mm"]) for name in ("position", "margin_below", "margin_above")
        )
        assert outcome.outputs["position.valid"]
        assert position - below <= truth.place_m * 1_000 <= position + above
        assert below <= 30_000 >= above
    assert {"ACCEPTED"} == {fix(one) for one in outcomes()[4:]}


def test_solutions_are_near_the_truth() -> None:
    """The place solved is metres from the truth where its protection level is tens of metres; the speed decimetres a second."""
    for outcome, truth in zip(outcomes()[4:], driven_run().truth[4:], strict=True):
        assert abs(int(outcome.inputs["position.fix_mm"]) - truth.place_m * 1_000) < 4_000
        assert abs(int(outcome.inputs["position.fix_speed_um_s"]) / 1e6 - truth.speed_m_per_s) < 0.3


def corrected(epoch: Epoch, place: Place) -> CorrectedEpoch:
    """What a program delivers that corrects an epoch of the simulated sky, near this place, and tells where the satellites are."""
    measured, states = {}, {}
    for name, signal in sky().signals(epoch).items():
        ephemeris = sky().valid(name, epoch.time_s)
        assert ephemeris is not None
        code, rate = epoch.satellites[name].code(), epoch.satellites[name].rate()
        full = satellite_state(ephemeris, epoch.time_s - code / LIGHT_M_PER_S)
        states[name] = replace(full, clock_s=0.0, clock_drift=0.0)
        whole, bare = signal(epoch.time_s, place, STILL), predicted_of_state(states[name], place, STILL)
        clock_rate = whole.rate_m_per_s - bare.rate_m_per_s
        measured[name] = Measured(code - (whole.pseudorange_m - bare.pseudorange_m), rate - clock_rate)
    return CorrectedEpoch(Epoch(epoch.time_s, measured), states)


def test_corrected_ranges_locate_without_ephemerides() -> None:
    """The same drive from corrected ranges and places of satellites: the same satellites are usable, and the place is the same to 0.2 m."""
    points = [Place.of_earth_fixed(TRACK.at(truth.place_m)[0]) for truth in driven_run().truth]
    epochs = [corrected(epoch, point) for epoch, point in zip(driven_run().epochs, points, strict=True)]
    one = EpochChain(CONFIG, CorrectedSky(epochs), lambda low_m, high_m: (TRACK,))
    found = driven(one, [each.epoch for each in epochs], start(driven_run()))
    assert [one.usable for one in found] == [one.usable for one in outcomes()]
    for outcome, known, truth in zip(found, outcomes(), driven_run().truth, strict=True):
        position, below, above = (
            int(outcome.outputs[f"position.{name}_mm"]) for name in ("position", "margin_below", "margin_above")
        )
        assert outcome.outputs["position.valid"]
        assert position - below <= truth.place_m * 1_000 <= position + above
        assert abs(position - int(known.outputs["position.position_mm"])) < 200
    assert {"ACCEPTED"} == {fix(one) for one in found[4:]}


def test_no_healthy_satellite_is_excluded() -> None:
    """Nothing is disturbed, the train starts and gains speed: the threshold rule keeps all of them."""
    assert not [name for one in outcomes() for name, standing in one.standings.items() if standing == "EXCLUDED"]
    assert min(len(one.usable) for one in outcomes()[4:]) > 8


def test_protection_levels_are_confirmed() -> None:
    """z3, over the rationals, for the geometry in use: place and speed of every tenth epoch, as told and as the machine adds.

    A signal may be off by threshold, prediction and clock together, and by what the map and linearising cost.
    """
    charged_mm, charged_mm_s = 9_500 + 3_100 + 2_100, 1_150 + 700 + 100
    for outcome in outcomes()[4::10]:
        assert outcome.solution is not None
        (solved,) = outcome.solution.solved
        levels = (
            (solved.place, solved.bounds.range_mm, "fix_dilution_permille", "fix_further_mm", charged_mm, 1),
            (solved.speed, solved.bounds.speed_mm_s, "fix_speed_dilution_permille", "fix_speed_further_um_s", charged_mm_s, 1_000),
        )  # fmt: skip
        for found, beside, dilution, further, added, fine in levels:
            assert found is not None and beside is not None
            bounds = dict.fromkeys(found.shares, added + beside)
            level = int(outcome.inputs[f"position.{dilution}"]) * added // 1_000
            level += int(outcome.inputs[f"position.{further}"]) // fine + 1
            assert isinstance(protected(found.shares, bounds, level), Proved)


def test_the_step_replays() -> None:
    """The inputs, put into the interpreter, give the outputs that the chain told."""
    system = without_ghosts(compose_machines(CONFIG.satellite).composition.system)
    trace = run(system, [one.inputs for one in outcomes()])
    assert [one.outputs for one in outcomes()] == [step.outputs for step in trace.steps]


def test_only_usable_satellites_are_used() -> None:
    """A detour of 80 m on one signal: it is excluded in that very epoch, and the solution is made without it."""
    sim = driven_run()
    struck = sorted(outcomes()[20].usable)[0]
    epochs = [*sim.epochs[:20], changed(sim.epochs[20], **{struck: 80.0}), sim.epochs[21]]
    hit = driven(chain(), epochs, start(sim))[20]
    assert "EXCLUDED" == hit.standings[struck]
    assert hit.solution is not None and struck not in hit.solution.used
    assert hit.solution.used == hit.usable
    assert "ACCEPTED" == fix(hit)


def test_without_an_epoch_it_coasts_on_the_prediction() -> None:
    """The state is E*(t), to the nanometre, and after the limit nothing is reported."""
    sim = driven_run()
    found = driven(chain(), [*sim.epochs[:20], *[None] * 12], start(sim))
    for outcome in found[20:30]:
        assert outcome.ahead is not None and "NO_EPOCH" == missing(outcome)
        assert outcome.ahead.position_nm // 10**6 == outcome.outputs["position.position_mm"]
        assert (
            -((outcome.ahead.low_nm - outcome.ahead.position_nm) // 10**6)
            == outcome.outputs["position.margin_below_mm"]
        )
    assert [True, False] == [found[29].outputs["position.valid"], found[31].outputs["position.valid"]]


def test_nothing_starts_without_a_reference() -> None:
    """Epochs alone leave it unlocated: nothing is predicted, so nothing is compared."""
    one = chain()
    found = [one.step(Cycle(epoch)) for epoch in driven_run().epochs[:3]]
    assert {("UNLOCATED", "NO_PREDICTION")} == {
        ("LOCATED" if each.outputs["position.valid"] else "UNLOCATED", missing(each)) for each in found
    }
    assert {"SILENT"} == {standing for each in found for standing in each.standings.values()}


def test_expired_ephemerides_are_not_used() -> None:
    """Two hours after their reference time less than none are left: each is named, and there is no solution (SAT-D1)."""
    old = Navigation(tuple(replace(one, orbit_time_s=one.orbit_time_s - 7_300) for one in sky().ephemerides), None)
    found = driven(chain(CONFIG, old), driven_run().epochs[:4], start(driven_run()))[-1]
    assert {"EXPIRED"} == set(found.standings.values())
    assert "NONE_LEFT" == missing(found)
    assert set(found.standings) == {fault.channel for fault in found.faults if fault.reason is Reason.STALE}


def test_what_is_not_finite_is_left_out_and_named() -> None:
    """NaN for one satellite, text for another, a third told twice: three faults, and the rest goes on."""
    sim, names = driven_run(), sorted(outcomes()[20].usable)
    rows = [Row(name, one.pseudorange_m, one.rate_m_per_s) for name, one in sim.epochs[20].satellites.items()]
    wrong = {names[0]: math.nan, names[1]: "far"}
    rows = [replace(row, pseudorange_m=wrong.get(row.satellite, row.pseudorange_m)) for row in rows]
    rows.append(next(row for row in rows if row.satellite == names[2]))
    one = chain()
    driven(one, sim.epochs[:20], start(sim))
    epoch, faults = received(sim.epochs[20].time_s, rows)
    outcome = one.step(Cycle(epoch, faults=faults))
    told = {fault.channel: fault.reason for fault in outcome.faults}
    assert {names[0]: Reason.NOT_FINITE, names[1]: Reason.WRONG_TYPE, names[2]: Reason.DUPLICATE} == told
    assert {"SILENT"} == {outcome.standings[name] for name in names[:3]}
    assert "ACCEPTED" == fix(outcome)


@pytest.mark.parametrize(("late_s", "reason"), [(-0.2, Reason.STALE), (0.15, Reason.FUTURE)])
def test_an_epoch_of_another_cycle_is_refused(late_s: float, reason: Reason) -> None:
    """A whole cycle late, or three quarters early: named, and the cycle goes on without one."""
    sim = driven_run()
    one = chain()
    driven(one, sim.epochs[:20], start(sim))
    outcome = one.step(Cycle(replace(sim.epochs[20], time_s=sim.epochs[20].time_s + late_s)))
    assert [("epoch", reason)] == [(fault.channel, fault.reason) for fault in outcome.faults]
    assert "NO_EPOCH" == missing(outcome)


def test_more_satellites_than_channels() -> None:
    """Four channels: four satellites are judged, every other one is named; three are enough."""
    few = ChainConfig(satellite=SatelliteConfig(selection=SelectionConfig(channels=4)), window_epochs=2)
    found = driven(chain(few), driven_run().epochs[:10], start(driven_run()))[-1]
    assert 4 == len(found.standings)
    assert {Reason.SURPLUS} == {fault.reason for fault in found.faults}


def _branching() -> Portion:
    """Another way from the same place: 20 m to the east at its end."""
    first, last = TRACK.points
    place = Place.of_earth_fixed(last)
    aside = Place(place.latitude_rad, place.longitude_rad + 20 / 6.4e6 / math.cos(place.latitude_rad), place.height_m)
    return Portion(0.0, (first, aside.earth_fixed_m()), (TRACK.end_m,))


def test_an_undecided_switch_predicts_on_both() -> None:
    """A satellite has to fit on both ways, and the interval holds what is solved on either."""
    sim = driven_run()
    both = driven(chain(CONFIG, sky(), TRACK, _branching()), sim.epochs[:20], start(sim))[-1]
    assert both.solution is not None and 2 == len(both.solution.solved) == len(both.sighting.residuals)
    alone = outcomes()[19]
    widths = [int(one.inputs["position.fix_further_mm"]) for one in (alone, both)]
    assert widths[0] <= widths[1]
    assert both.outputs["position.valid"]


def test_an_undecided_switch_may_stop_the_prediction() -> None:
    """Configured so, nothing is predicted there, and the reason is told."""
    config = CONFIG.model_copy(update={"at_switch": "none"})
    sim = driven_run()
    found = driven(chain(config, sky(), TRACK, _branching()), sim.epochs[:5], start(sim))[-1]
    assert ("TWO_PORTIONS", None) == (missing(found), found.solution)


def test_beyond_the_map_nothing_is_predicted() -> None:
    """A track that ends behind the train: no prediction, and coasting."""
    short = Portion(-50.0, TRACK.points, (100.0,))
    found = driven(chain(CONFIG, sky(), short), driven_run().epochs[:4], start(driven_run()))[-1]
    assert ("NO_PREDICTION", True) == (missing(found), bool(found.outputs["position.coasting"]))


def test_free_of_the_track_more_satellites_are_needed() -> None:
    """Two unknowns more; the solution is as near the truth."""
    config = CONFIG.model_copy(update={"solution": "free"})
    sim = driven_run()
    found = driven(chain(config), sim.epochs[:20], start(sim))[-1]
    along = outcomes()[19].solution
    assert along is not None and found.solution is not None
    assert along.unknowns + 2 == found.solution.unknowns
    assert abs(int(found.inputs["position.fix_mm"]) - sim.truth[19].place_m * 1_000) < 4_000


@pytest.mark.thorough(ordinary=1)
@pytest.mark.parametrize("compared", ["doppler", "pseudorange"])
def test_what_is_not_compared_is_not_solved(compared: str) -> None:
    """Doppler alone gives the speed, and the place stays the predicted one; pseudorange alone leaves the speed open."""
    selection = SELECTION.model_copy(update={"compared": compared})
    config = CONFIG.model_copy(update={"satellite": CONFIG.satellite.model_copy(update={"selection": selection})})
    sim = driven_run()
    found = driven(chain(config), sim.epochs[:20], start(sim))[-1]
    assert found.solution is not None
    (solved,) = found.solution.solved
    assert (compared == "doppler", compared == "pseudorange") == (solved.place is None, solved.speed is None)
    assert found.outputs["position.valid"]


def test_odometry_checks_but_does_not_locate() -> None:
    """A run that agrees changes nothing; one that does not, ends the position, and never moves it."""
    sim = driven_run()
    way = [0, *(round((b.place_m - a.place_m) * 1_000) for a, b in zip(sim.truth, sim.truth[1:], strict=False))]

    def positions(factor: int) -> list[int]:
        one = chain()
        cycles = (
            Cycle(e, start(sim) if n == 0 else None, Run(w * factor, 20))
            for n, (e, w) in enumerate(zip(sim.epochs, way, strict=True))
        )
        return [
            int(done.outputs["position.position_mm"])
            for done in map(one.step, cycles)
            if done.outputs["position.valid"]
        ]

    plain = [int(one.outputs["position.position_mm"]) for one in outcomes()]
    assert plain == positions(1)
    away = positions(-2)
    assert plain[: len(away)] == away
    assert len(away) < len(plain)


def test_along_the_valley() -> None:
    """The worked line with a course: from its map to reports that hold the truth, through a transition into a curve."""
    pytest.importorskip("pyproj")
    topology = Topology(find_line("valley"))
    route = next(one for one in through_routes(topology, 10) if one.runs[0].direction == "increasing")
    track = LineTrack([route], 160.0)
    (portion,) = track.portions(0.0, 1.0)
    sim = simulate(World(sky(), portion), ride(24.0, 200, start_m=600), seed=5)
    found = driven(EpochChain(CONFIG, sky(), track.portions), sim.epochs, start(sim))
    assert sim.truth[-1].place_m > 800 and portion.bend_per_m(790.0, 810.0) > 1 / 850
    for outcome, truth in zip(found, sim.truth, strict=True):
        position, below, above = (
            int(outcome.outputs[f"position.{name}_mm"]) for name in ("position", "margin_below", "margin_above")
        )
        assert outcome.outputs["position.valid"]
        assert position - below <= truth.place_m * 1_000 <= position + above
    assert {"ACCEPTED"} == {fix(one) for one in found[-20:]}
    assert not [name for one in found for name, standing in one.standings.items() if standing == "EXCLUDED"]


def recorded(selection: SelectionConfig, *, with_almanac: bool) -> tuple[list[Outcome], int]:
    """A geodetic receiver on a surveyed point, on an imagined track to the east, and where that is, mm; the almanac is made of the
    recorded ephemerides."""
    navigation = read_navigation(data_file("gnss_septentrio/base.nav"))
    epochs = read_observations(data_file("gnss_septentrio/rover.obs"))[:60]
    standing = SatelliteConfig(selection=selection, period_ms=1_000, max_acceleration_mm_s2=100, max_speed_mm_s=5_000)
    config = CONFIG.model_copy(update={"satellite": standing})
    ends = (
        Place.degrees(35.13469901, longitude, 104.8626).earth_fixed_m() for longitude in (136.97657549, 136.97857549)
    )
    portion = Portion(-91.0, tuple(ends))
    middle_mm = round((portion.start_m + portion.end_m) / 2 * 1_000)
    known = broadcast_almanac(navigation.ephemerides) if with_almanac else None
    standing_still = EpochChain(config, navigation, lambda low_m, high_m: (portion,), known)
    return driven(standing_still, epochs, Reference(middle_mm, 2_000, 0, 50)), middle_mm


AT_REST = SELECTION.model_copy(update={"range_prediction_mm": 3_200})


def test_the_recorded_receiver_stays_where_it_is() -> None:
    """It is located, with the point inside."""
    found, middle_mm = recorded(AT_REST, with_almanac=False)
    for outcome in found[4:]:
        assert "ACCEPTED" == fix(outcome)
        assert abs(int(outcome.inputs["position.fix_mm"]) - middle_mm) < 2_500
        assert abs(outcome.outputs["position.position_mm"] - middle_mm) < 2_000
