"""The satellite chain, epoch by epoch: from observations, ephemerides and map to the machine's step (SAT-1 to SAT-6).

    chain = EpochChain(ChainConfig(), navigation, LineTrack(routes, height_m).portions, almanac)
    for epoch in epochs:                                  # one call a machine cycle, also without an epoch
        outcome = chain.step(Cycle(epoch))                # Cycle(epoch, reference=..., run=..., faults=...)
        outcome.outputs["valid"], outcome.outputs["position_mm"]

One cycle at time t:

1. E(t-1) is the machine's own state. E*(t) follows from it at constant acceleration, laid along the portion of track that
   the map gives; no other sensor enters (SAT-1). At an undecided switch it is laid along both portions, or along none.
2. The almanac, if there is one, gives its age and the elevation of each received satellite from there; the selection
   machine uses it only while it is current (SAT-6). Pseudorange and range rate are predicted from the ephemerides that are valid (SAT-2), and taken from the measured ones;
   the receiver's clock goes by the median of each constellation.
3. The selection machine gives the usable satellites (LSVU) of this cycle. The sky is looked at again by their signals alone,
   clock and time of the measurement included, and position and speed are solved from that (SAT-5), with their dilution,
   sum |a_i|. Every solution is solved again, by another method, from the satellites that it names; one that does not follow
   from usable ones is no solution (`Outcome.unconfirmed`). The machine itself adds the greatest error of a usable signal,
   times the dilution.
4. The composed machine takes one step with the same inputs. `outcome.inputs` is that step: written to a step stream, it
   replays to the same result.

Nothing raises for what a receiver delivers: what is not finite, expired, late or left over is a fault or a reason in the
outcome. Cycles follow each other by the machine's period; an epoch that is half of it or more away is not of this cycle.
The receiver's clock may be wrong by less than that. The first epoch with usable satellites is that of its cycle's time.
"""

from __future__ import annotations

from collections.abc import Mapping, Sequence
from dataclasses import dataclass, replace
from functools import lru_cache
from typing import Literal, Protocol

from pydantic import Field

from safeloc.codegen.compiled import Compiled, compile_system
from safeloc.config import Config, quantity
from safeloc.errors import InputError
from safeloc.language.nodes import Value
from safeloc.language.system import lower, without_ghosts
from safeloc.models.satellite import compose_machines
from safeloc.models.satellite.ahead import Ahead, ahead
from safeloc.models.satellite.fix_inputs import StepValues, fix_inputs, no_fix
from safeloc.models.satellite.sighting import Sighting, Track, sighted, true_time_s
from safeloc.models.satellite.trusted_inputs import Reference, Run, trusted_inputs
from safeloc.models.satellite.variables import SatelliteConfig
from safeloc.models.satellite_selection import STANDING
from safeloc.models.satellite_selection.variables import OLDEST_S
from safeloc.runtime.border import Fault, Reason
from safeloc.sensing.satellite.almanac import Almanac
from safeloc.sensing.satellite.channels import Channels, ChannelValues, Received, differences
from safeloc.sensing.satellite.confirmation import refuted
from safeloc.sensing.satellite.epochs import Epoch
from safeloc.sensing.satellite.places import Place
from safeloc.sensing.satellite.residuals import Kept, Sky
from safeloc.sensing.satellite.solution import Bounds, Look, Solution, Weighting, solve
from safeloc.sensing.satellite.track_fit import NoSolution

__all__ = ["ChainConfig", "Cycle", "EpochChain", "Outcome", "Reference", "Run", "Solver", "Track"]


class ChainConfig(Config):
    """Configuration of the chain.

    at_switch   both: predict on every possible portion, and take what holds on each; none: no prediction there
    solution    along track: two unknowns; free: the directions across the track are unknown too (two satellites more)
    weighting   of the least squares: equal, or by the square of the sine of elevation
    """

    satellite: SatelliteConfig = SatelliteConfig()
    window_epochs: int = quantity(5, "epochs", 2, 1_000, "[D] variance over 1 s at 5 Hz; two are the least")
    map_error_mm: int = quantity(200, "mm", 0, 100_000, "[D] surveyed course and antenna against the track's axis")
    at_switch: Literal["both", "none"] = Field(default="both", description="prediction at an undecided switch")
    solution: Literal["along track", "free"] = Field(default="along track", description="what is solved")
    weighting: Weighting = Field(default="equal", description="weights of the least squares")

    @property
    def bounds(self) -> Bounds:
        """Errors to add to a used signal's own: the map's, in the quantities that are compared."""
        compared = self.satellite.selection.compared
        return Bounds(
            None if compared == "doppler" else self.map_error_mm,
            None if compared == "pseudorange" else 0,
        )


@dataclass(frozen=True, slots=True)
class Cycle:
    """Inputs of one cycle; `faults`: inputs that the receiver's border refused (`epochs.received`)."""

    epoch: Epoch | None = None
    reference: Reference | None = None
    run: Run | None = None
    faults: tuple[Fault, ...] = ()


@dataclass(frozen=True)
class Outcome:
    """One cycle.

    inputs     the composed machine's step, by name; outputs: what it says afterwards
    fired      the transitions that fired, by machine
    ahead      E*(t); None while unlocated
    standings  per visible satellite, what the selection says: USABLE, EXCLUDED, WARMING, SILENT, EXPIRED, UNLISTED, ABSENT
    sighting   residuals of all that is visible on every possible portion, none without a prediction
    solution   fits with bounds; None without one: `outputs["position.missing"]` says why
    unconfirmed  why a solution was refused that does not follow from usable satellites that it names; otherwise empty
    faults     what was left out, with the reason
    """

    inputs: StepValues
    outputs: Mapping[str, Value]
    fired: Mapping[str, str]
    ahead: Ahead | None
    standings: Mapping[str, str]
    sighting: Sighting
    solution: Solution | None
    unconfirmed: str
    faults: tuple[Fault, ...]

    @property
    def usable(self) -> frozenset[str]:
        """The satellites in the list of usable ones (LSVU)."""
        return frozenset(name for name, standing in self.standings.items() if standing == "USABLE")


class Solver(Protocol):
    """A function that solves for place and speed from the named satellites; NoSolution if there is no solution."""

    def __call__(self, looks: Sequence[Look], used: frozenset[str], *, free: bool, weighting: Weighting) -> Solution:
        """Solve on every look."""
        ...


UNLOCATED = 0
"""The position machine's first mode."""


@lru_cache(maxsize=8)
def _programs(figures: str) -> tuple[Compiled, Compiled]:
    """Return the compiled composition and the compiled selection alone, for a configuration in JSON.

    Compiling takes seconds for 32 channels, so each configuration is compiled once.
    """
    model = compose_machines(SatelliteConfig.model_validate_json(figures))
    selection = lower(model.selection.machine)
    return compile_system(without_ghosts(model.composition.system)), compile_system(without_ghosts(selection))


class EpochChain:
    """The on-board system: receiver channels, memory with almanac, ephemerides and map, and the machine (SAT-6).

    sky      ephemerides (`read_navigation`), or states that came with corrected ranges (`CorrectedSky`)
    almanac  None: there is none, as before the receiver has collected it
    solver   is checked in every cycle, so nothing is trusted of it
    """

    def __init__(
        self,
        config: ChainConfig,
        sky: Sky,
        track: Track,
        almanac: Almanac | None = None,
        solver: Solver = solve,
    ) -> None:
        self.config = config
        self._sky, self._track, self._almanac, self._solver = sky, track, almanac, solver
        self._code, self._select = _programs(config.satellite.model_dump_json())
        self._state, self._selected = self._code.first(), self._select.first()
        self._channels = Channels(config.satellite.selection.channels, config.window_epochs)
        self._due_s: float | None = None
        self._timed = False

    @property
    def state(self) -> dict[str, Value]:
        """The composed machine's state by name."""
        return dict(zip(self._code.state_names, self._state, strict=True))

    def step(self, cycle: Cycle) -> Outcome:
        """Make one cycle. InputError for a reference or a run out of the range of the machine's inputs."""
        before = self.state
        predicted = ahead(before, self.config.satellite) if before["position.mode"] != UNLOCATED else None
        epoch, late = self._of_this_cycle(cycle.epoch)
        kept: Kept = {}
        seen = self._sighting(epoch, predicted, kept)
        received = self._received(epoch, seen)
        standings = self._standings(received)
        usable = frozenset(name for name, standing in standings.items() if standing == "USABLE")
        alone = self._of_usable(epoch, predicted, seen, usable, kept)
        solution, missing, unconfirmed = self._solution(predicted, alone, usable)
        fix = no_fix(missing)
        if solution is not None and predicted is not None:
            fix = self._fix(solution, predicted, alone.offset_s)
        inputs = {**self._channel_inputs(received, solution), **fix, **trusted_inputs(cycle.reference, cycle.run)}
        self._state, numbers = self._code.step(self._state, self._code.read(inputs))
        outputs, fired = self._code.named_outputs(self._state), self._code.fired(numbers)
        faults = (*cycle.faults, *late, *received.faults)
        return Outcome(inputs, outputs, fired, predicted, standings, seen, solution, unconfirmed, faults)

    # ------------------------------------------------------------------ what is seen

    def _of_this_cycle(self, epoch: Epoch | None) -> tuple[Epoch | None, tuple[Fault, ...]]:
        """The epoch if it is of this cycle: less than half a period away from when the cycle is due."""
        if self._due_s is None:
            return epoch, ()
        self._due_s += self.config.satellite.period_ms / 1_000
        off_s = 0.0 if epoch is None else epoch.time_s - self._due_s
        if abs(off_s) * 2_000 < self.config.satellite.period_ms:
            return epoch, ()
        return None, (Fault("epoch", Reason.STALE if off_s < 0 else Reason.FUTURE, f"{off_s:+.3f} s off the cycle"),)

    def _sighting(self, epoch: Epoch | None, predicted: Ahead | None, kept: Kept) -> Sighting:
        if epoch is None or predicted is None:
            return Sighting("NO_EPOCH" if epoch is None else "NO_PREDICTION")
        portions = self._track(*predicted.stretch_m())
        if len(portions) > 1 and self.config.at_switch == "none":
            return Sighting("TWO_PORTIONS")
        if self._due_s is None:
            try:
                self._due_s = true_time_s(epoch, predicted, portions, self._sky)
            except InputError:
                return Sighting("NO_PREDICTION")
        return sighted(epoch, predicted, portions, self._due_s, self._sky, kept)

    def _of_usable(
        self, epoch: Epoch | None, predicted: Ahead | None, seen: Sighting, usable: frozenset[str], kept: Kept
    ) -> Sighting:
        """The same sky by usable satellites alone (SAT-5): no other one has a part in clock, differences or time.

        When the cycles are due is known from all satellites at first, for the criterion, and from usable ones as soon as there
        are any: nothing has been solved until then.
        """
        if epoch is None or predicted is None or self._due_s is None or seen.missing or not usable:
            return seen
        alone = epoch.only(usable)
        try:
            if not self._timed:
                self._due_s, self._timed = true_time_s(alone, predicted, seen.portions, self._sky), True
            return sighted(alone, predicted, seen.portions, self._due_s, self._sky, kept)
        except InputError:
            return Sighting("NO_PREDICTION")

    def _received(self, epoch: Epoch | None, seen: Sighting) -> Received:
        """Every satellite of the epoch above the mask is visible (LSV)."""
        names = frozenset() if epoch is None else frozenset(epoch.satellites)
        predictable = frozenset() if epoch is None else frozenset(self._sky.signals(epoch))
        low = frozenset().union(*(look.low for look in seen.residuals))
        at_s = 0.0 if epoch is None else epoch.time_s
        received = self._channels.hear(names - low, predictable - low, seen.residuals)
        return replace(received, inputs={**received.inputs, **self._by_almanac(received, seen, at_s)})

    def _by_almanac(self, received: Received, seen: Sighting, at_s: float) -> ChannelValues:
        """Return the almanac's age, and by it the elevation of every satellite on a channel, the least of all portions."""
        age_s = None if self._almanac is None or not seen.places else self._almanac.age_s(at_s)
        if self._almanac is None or age_s is None:
            return {}
        values: ChannelValues = {"almanac_age_s": min(age_s, OLDEST_S)}
        places = [Place.of_earth_fixed(one.point_m) for one in seen.places]
        for name, number in received.channels.items():
            elevations = [self._almanac.elevation_mrad(name, at_s, place) for place in places]
            known = [one for one in elevations if one is not None]
            if known:
                values[f"channel_{number}_almanac_mrad"] = min(known)
        return values

    # ------------------------------------------------------------------ what becomes of it

    def _standings(self, received: Received) -> dict[str, str]:
        """Run one step of the selection machine; return the standing of every satellite on a channel."""
        self._selected, _ = self._select.step(self._selected, self._select.read(received.inputs))
        state = dict(zip(self._select.state_names, self._selected, strict=True))
        return {
            name: STANDING[int(state[f"channel_{number}_standing"])].label for name, number in received.channels.items()
        }

    def _solution(
        self, predicted: Ahead | None, alone: Sighting, usable: frozenset[str]
    ) -> tuple[Solution | None, str, str]:
        """Return the solution from usable satellites only, or None with the reason, and why a solution was refused."""
        if predicted is None or alone.missing:
            return None, alone.missing, ""
        if not usable:
            return None, "NONE_LEFT", ""
        looks = self._looks(predicted, alone)
        there = usable.intersection(*(look.measured for look in looks))
        free, weighting = self.config.solution == "free", self.config.weighting
        try:
            solution = self._solver(looks, there, free=free, weighting=weighting)
        except NoSolution as none:
            return None, none.why, ""
        why = refuted(solution, looks, there, free=free, weighting=weighting)
        return (None, "UNCONFIRMED", why) if why else (solution, "", "")

    def _looks(self, predicted: Ahead, alone: Sighting) -> list[Look]:
        """Return the usable satellites seen from the prediction on each portion, with the bounds of the further errors there."""
        estimate = predicted.estimate(alone.offset_s)
        looks: list[Look] = []
        for place, portion, found in zip(alone.places, alone.portions, alone.residuals, strict=True):
            bounds, off = self.config.bounds.on_track(estimate, portion, alone.distance_m), differences(found)
            looks.append(Look(place, bounds, off.off_mm, off.speed_off_mm_s, found.predictions))
        return looks

    def _fix(self, solution: Solution, predicted: Ahead, offset_s: float) -> StepValues:
        return fix_inputs(solution, predicted, offset_s, self.config.satellite)

    def _channel_inputs(self, received: Received, solution: Solution | None) -> StepValues:
        used = {received.channels[name] for name in (frozenset() if solution is None else solution.used)}
        inputs: StepValues = {f"selection.{name}": value for name, value in received.inputs.items()}
        channels = range(1, self.config.satellite.selection.channels + 1)
        return inputs | {f"position.used_{number}": number in used for number in channels}
