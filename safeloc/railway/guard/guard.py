"""The guard at work: it judges every delivery with the proved machine and the map.

The machine steps once in every period of the receiver's clock, and with every delivery. It alone judges the content of a
delivery; this module compares its time with earlier ones and looks its place up on the map.
"""

from __future__ import annotations

import math
from collections.abc import Iterable, Iterator
from dataclasses import dataclass, replace
from functools import cache

from safeloc.codegen.compiled import Compiled, compile_system
from safeloc.errors import InputError
from safeloc.language.nodes import Value
from safeloc.language.system import lower, without_ghosts
from safeloc.language.units import NM_PER_MM
from safeloc.models.guard import build
from safeloc.models.guard.variables import FARTHEST_OFF_MM, FAULT, JUDGED, GuardConfig, parts
from safeloc.railway.guard.course import Courses
from safeloc.railway.guard.deliveries import Delivery
from safeloc.railway.guard.other_way import Beside, OtherWay
from safeloc.railway.guard.tracks import Match, Tracks, Window
from safeloc.railway.map.places import Place
from safeloc.runtime.border import Deliveries, Raw, Reason

MODES = ("WITHDRAWN", "RECOVERING", "PASSING", "PROBATION")
_BEGINS = {"first fix", "fix begins anew", "fix agrees", "receiver believed"}
"""Transitions after which only this fix determines the way, because earlier fixes may have been false."""
_GOES_ON = {"fix passed on", "receiver believed again"}
_FAULT_NUMBER = {fault.label: number for number, fault in enumerate(FAULT)}


@dataclass(frozen=True)
class Judgement:
    """The decision about one delivery.

    passed            true if it is passed on
    reason            PASSED, or the reason why it is withheld
    mode              of the guard after it
    at_ms             the time for which interval and window hold: the delivery's, rounded up to a whole period
    interval_mm       the vehicle's interval along the way, if it is known within the tolerance
    window_mm         the same, also if wider; None while no position is held
    position_mm, offset_mm, place   place of the fix on the map; None without a fix
    ends              places of the interval's ends; None if more than one track leads there
    beside            of a fix that is passed on along a given way: how many of the last ones lie nearer to a track off it
    detail            further details of the reason, in words
    """

    delivery: Delivery
    passed: bool
    reason: str
    mode: str
    at_ms: int | None = None
    interval_mm: tuple[int, int] | None = None
    window_mm: tuple[int, int] | None = None
    position_mm: int | None = None
    offset_mm: int | None = None
    place: Place | None = None
    ends: tuple[Place | None, Place | None] = (None, None)
    beside: Beside | None = None
    detail: str = ""


class Guard:
    """The guard of one receiver on one vehicle. It has no clock of its own; all its state is in this object."""

    def __init__(self, config: GuardConfig, tracks: Tracks) -> None:
        """InputError for a route that is longer than `position_limit_mm`."""
        ends = [laid.start_mm + tracks.topology.length_mm(laid.run) for laid in tracks.route or ()]
        if max(ends, default=0) > config.position_limit_mm:
            raise InputError(f"the way is {max(ends)} mm long; raise position_limit_mm {config.position_limit_mm}.")
        self.config, self.tracks = config, tracks
        self._code = _code(config.model_dump_json())
        self._state = self._code.first()
        self._idle = self._code.read(self._inputs(advance=True))
        self._courses, self._other_way = Courses(config, tracks), OtherWay(tracks)
        self._deliveries = Deliveries()
        self._now_ms: int | None = None
        self._at_ms: int | None = None
        self._ways = [True, True]
        self._backwards: list[int] = []
        self._place: tuple[float | None, float | None] = (None, None)

    def start_anew(self) -> None:
        """Forget every place, because the host declares earlier positions invalid.

        Otherwise, on a known route, an accepted place is kept for good, and positions that the vehicle cannot have reached from
        it are withheld. Call this when a first place was wrong, or when the vehicle was turned or moved by other means.
        """
        self._state, _ = self._code.step(self._state, self._code.read(self._inputs(start_anew=True)))
        self._courses.forget()
        self._other_way.forget()

    def judge_all(self, deliveries: Iterable[Delivery]) -> Iterator[Judgement]:
        """Yield a judgement for each delivery as it arrives."""
        return (self.judge(delivery) for delivery in deliveries)

    def judge(self, delivery: Delivery) -> Judgement:
        """Judge one delivery."""
        if delivery.wrong:
            return self._step(delivery, "MALFORMED", delivery.wrong)
        if delivery.time_ms is None:
            return self._step(delivery, "NO_FIX", "no time")
        came = delivery.time_ms if delivery.received_ms is None else delivery.received_ms
        now = came if self._now_ms is None else max(came, self._now_ms)
        late = self._late(delivery.time_ms, now)
        if late is not None and self._now_ms is None:
            return self._step(delivery, *late)
        ahead = self._run_until(now)
        fault = late or _no_position(delivery) or self._frozen(delivery)
        if fault is not None:
            return self._step(delivery, *fault)
        try:
            match = self._matched(delivery)
        except InputError as error:
            return self._step(delivery, "MALFORMED", str(error))
        if match.offset_mm > FARTHEST_OFF_MM:
            return self._step(delivery, "OFF_TRACK", f"{match.offset_mm} mm off the nearest track")
        return self._located(delivery, match, now - delivery.time_ms + ahead)

    # -------------------------------------------------------------- time

    def _late(self, time_ms: int, now_ms: int) -> tuple[str, str] | None:
        """Return what is wrong with the time (reason, detail); None if it is new and in time."""
        found = self._deliveries.fault("fix", Raw(0, time_ms), now_ms, self.config.max_age_ms)
        self._backwards = [*self._backwards, time_ms] if found and found.reason is Reason.OUT_OF_ORDER else []
        if found and len(self._backwards) >= self.config.confirmations and sorted(self._backwards) == self._backwards:
            self._begin_anew()
        return None if found is None else (found.reason.name, found.detail)

    def _begin_anew(self) -> None:
        """Withdraw the held position as after a silence, since the receiver's clock was set back for good; keep the known way."""
        while self._mode != "WITHDRAWN":
            self._state, _ = self._code.step(self._state, self._idle)
        self._deliveries = Deliveries()
        self._courses.forget()
        self._now_ms, self._at_ms, self._backwards = None, None, []

    def _run_until(self, now_ms: int) -> int:
        """Step until the machine's time reaches this one; return by how many ms it is then ahead."""
        if self._now_ms is None:
            self._start_ms = self._now_ms = now_ms
        period = self.config.period_ms
        steps = -((self._now_ms - self._start_ms) // -period)
        wanted = -((now_ms - self._start_ms) // -period)
        self._now_ms = now_ms
        for _ in range(wanted - steps):
            before = self._state
            self._state, _ = self._code.step(before, self._idle)
            self._note_ways()
            if self._state == before:
                break
        self._at_ms = self._start_ms + wanted * period
        return self._at_ms - now_ms

    # -------------------------------------------------------------- place

    def _frozen(self, delivery: Delivery) -> tuple[str, str] | None:
        """Refuse a place that is equal to the last digit although the vehicle runs; None if it differs or the vehicle may rest."""
        place, self._place = self._place, (delivery.x, delivery.y)
        reported = delivery.speed_mm_s is not None and delivery.speed_mm_s > self.config.speed_error_mm_s
        runs = self._value("slow_um_s") > 0 or self._value("fast_um_s") < 0
        return ("DUPLICATE", "the same place again at speed") if place == self._place and (reported or runs) else None

    def _matched(self, delivery: Delivery) -> Match:
        assert delivery.x is not None and delivery.y is not None
        if self._mode == "WITHDRAWN" and self.tracks.route is None:
            self._state = self._code.first()  # positions count from this fix on
        match = self.tracks.match(delivery.x, delivery.y, self._window(), alone=self._mode == "RECOVERING")
        if abs(match.position_mm) <= self.config.position_limit_mm:
            return match
        self._state = self._code.first()  # beyond the limit: positions count from this fix on
        return self.tracks.match(delivery.x, delivery.y, None)

    def _window(self) -> Window | None:
        """Return the possible positions of the vehicle, from the held position or from the row of agreeing fixes."""
        return None if self._mode == "WITHDRAWN" else self._held_window()

    def _held_window(self) -> Window:
        low, high = self._value("low_nm"), self._value("high_nm")
        return Window(low // NM_PER_MM, -(-high // NM_PER_MM), *self._ways)

    def _note_ways(self) -> None:
        """Update whether the vehicle can have run forwards, or backwards, since the last accepted fix."""
        self._ways = [self._ways[0] or self._value("fast_um_s") > 0, self._ways[1] or self._value("slow_um_s") < 0]

    def _remember(self, match: Match, fired: str) -> None:
        """Update the known way from an accepted fix."""
        if fired in _BEGINS:
            self.tracks.began(match)
        elif fired in _GOES_ON:
            self.tracks.took(match, self._held_window())
        else:
            return
        self._ways = [False, False]
        self._note_ways()

    # -------------------------------------------------------------- the machine

    def _step(self, delivery: Delivery, fault: str, detail: str) -> Judgement:
        """Step the machine with a delivery that has no position."""
        self._state, _ = self._code.step(self._state, self._code.read(self._inputs(fault=_FAULT_NUMBER[fault])))
        return self._judgement(delivery, None, detail)

    def _located(self, delivery: Delivery, match: Match, age_ms: int) -> Judgement:
        """Step the machine with a delivery that has a place on the map."""
        inputs = self._of_match(match, delivery, age_ms)
        self._state, numbers = self._code.step(self._state, self._code.read(inputs))
        (fired,) = self._code.fired(numbers).values()
        self._remember(match, fired)
        judgement = self._judgement(delivery, match, "")
        return replace(judgement, beside=self._beside(delivery, match)) if judgement.passed else judgement

    def _beside(self, delivery: Delivery, match: Match) -> Beside | None:
        assert delivery.x is not None and delivery.y is not None
        return self._other_way.passed(delivery.x, delivery.y, match.position_mm, match.offset_mm)

    def _judgement(self, delivery: Delivery, match: Match | None, detail: str) -> Judgement:
        outputs = self._code.named_outputs(self._state)
        window = (outputs["window_from_mm"], outputs["window_to_mm"]) if outputs["holding"] else None
        interval = None
        if outputs["valid"]:
            interval = (
                outputs["position_mm"] - outputs["margin_below_mm"],
                outputs["position_mm"] + outputs["margin_above_mm"],
            )
        return Judgement(
            delivery,
            bool(outputs["passed"]),
            JUDGED[int(outputs["reason"])].label,
            self._mode,
            self._at_ms,
            interval,
            window,
            None if match is None or match.elsewhere else match.position_mm,
            None if match is None else match.offset_mm,
            None if match is None else match.place,
            (None, None) if interval is None else (self.tracks.place(interval[0]), self.tracks.place(interval[1])),
            detail=detail,
        )

    def _inputs(self, **given: Value) -> dict[str, Value]:
        """Return the inputs of a step without a delivery, changed by those given."""
        return {
            "advance": False, "fault": 0, "fix_offset_mm": 0, "fix_age_ms": 0, "fix_ambiguous": False,
            "fix_elsewhere": False, "forwards_only": self.tracks.one_way, "start_anew": False, **given,
        }  # fmt: skip

    def _of_match(self, match: Match, delivery: Delivery, age_ms: int) -> dict[str, Value]:
        assert delivery.time_ms is not None and delivery.x is not None and delivery.y is not None
        course = self._courses.angle_mrad(delivery.time_ms, delivery.x, delivery.y)
        inputs = self._inputs(
            fix_mm=match.position_mm,
            fix_offset_mm=match.offset_mm,
            fix_age_ms=age_ms,
            fix_ambiguous=match.ambiguous,
            fix_elsewhere=match.elsewhere,
        )
        optional = {"fix_speed_mm_s": delivery.speed_mm_s, "fix_course_mrad": course}
        return {**inputs, **{name: value for name, value in optional.items() if value is not None}}

    @property
    def _mode(self) -> str:
        return MODES[self._value("mode")]

    def _value(self, name: str) -> int:
        return int(self._state[self._code.state_names.index(name)])


@cache
def _code(figures: str) -> Compiled:
    """Return the machine of a configuration (as JSON), compiled once for all receivers with this configuration."""
    config = GuardConfig.model_validate_json(figures)
    return compile_system(without_ghosts(lower(build(parts(config)).machine)))


def _no_position(delivery: Delivery) -> tuple[str, str] | None:
    """Return why the delivery has no position (reason, detail); None if it has one."""
    if delivery.x is None or delivery.y is None:
        return "NO_FIX", ""
    if not (math.isfinite(delivery.x) and math.isfinite(delivery.y)):
        return "NOT_FINITE", f"({delivery.x}, {delivery.y})"
    return None
