"""A counting head of which one channel comes free late: how far a wheel has run on where it is counted (FVA-4).

The machines are those that run on board, `axle_head` and `head_cycle`; only their worlds are left out, for here a channel may fail. It stays
damped after its wheel has left it, as long as it likes, and comes free by itself; at any wheel, and again at the next. A channel is damped by
its wheel at the latest when the wheel is on it, and begins to be damped by nothing else. In no sample are both channels late; one may be, and then the other.

    begins   the head, free before, is damped: a wheel has come on it
    ran      how far this wheel has run since it came on the head, also beyond it, in its direction
    gone     wheels that have passed since the head was free; 2 stands for any more
"""

from __future__ import annotations

from collections.abc import Iterator
from dataclasses import dataclass, replace

from safeloc.language.composition import Composition, compose
from safeloc.language.expr import (
    Bool,
    BoolVar,
    Expr,
    Lit,
    Num,
    NumVar,
    Var,
    abs_,
    all_of,
    between,
    boolean,
    exact_to,
    ite,
    maximum,
    minimum,
    number,
    with_unit,
)
from safeloc.language.machine import ANY
from safeloc.language.spec import Property, always, earlier_num
from safeloc.language.units import COUNT, UM, UM_PER_MM, UM_S, US, US_PER_S
from safeloc.language.world import World
from safeloc.models import axle_head
from safeloc.models.axle_head import DOWN, NO_AXLE, UP, AxleHead
from safeloc.models.axle_head.variables import BESIDE_UM
from safeloc.models.counting_head import CountingHeadConfig
from safeloc.models.counting_head.cycle import HeadCycle, head_cycle
from safeloc.models.counting_head.late_wheels import came_um_s, late_spans, pace_um_s
from safeloc.models.counting_head.world import change_um_s

_PM = UM_S.times(US)


@dataclass(frozen=True, eq=False)
class Truth:
    """Ghosts and choices beside those of the head."""

    speed: NumVar
    ran: NumVar
    up: BoolVar
    gone: NumVar
    damped: tuple[BoolVar, BoolVar]
    late: tuple[BoolVar, BoolVar]
    next_speed: NumVar
    run: NumVar


def _truth(config: CountingHeadConfig) -> Truth:
    fast = config.head.max_speed_mm_s * UM_PER_MM
    step = -(-fast * config.head.sample_us // US_PER_S)
    return Truth(
        number("true_speed_um_s", UM_S, -fast, fast),
        number("ran_um", UM, -BESIDE_UM, BESIDE_UM),
        boolean("came_up"),
        number("gone", COUNT, 0, 2),
        (boolean("a_was_damped"), boolean("b_was_damped")),
        (boolean("a_was_late"), boolean("b_was_late")),
        number("next_true_speed_um_s", UM_S, -fast, fast),
        number("run_um", UM, -step, step),
    )


@dataclass(frozen=True, eq=False)
class LateChannel:
    """The head and the adding up of its samples, in a world in which a channel may come free late."""

    config: CountingHeadConfig
    truth: Truth
    head: AxleHead
    cycle: HeadCycle
    composition: Composition


def compose_late(config: CountingHeadConfig | None = None) -> LateChannel:
    """Wire the head to the adding up of its samples."""
    config = config or CountingHeadConfig()
    truth, head = _truth(config), axle_head.build(axle_head.parts(config.head))
    failing = replace(head, machine=replace(head.machine, world=_world(config, truth, head), lemmas={}))
    cycle = head_cycle(config, head.machine.modes)
    board = replace(cycle, machine=replace(cycle.machine, world=World(), lemmas={}))
    wires: dict[Var, Expr] = {
        cycle.own.head_mode: failing.machine.mode,
        cycle.own.counted: failing.machine.output("counted"),
        cycle.own.may_miss: failing.machine.flag("may_miss"),
    }
    joined = compose("late_channel", [failing.machine, board.machine], wires)
    whole = LateChannel(config, truth, failing, board, joined)
    system = replace(joined.system, lemmas=dict(_lemmas(whole)))
    return replace(whole, composition=replace(joined, system=system))


# ------------------------------------------------------------------ the world


def _stretches(config: CountingHeadConfig, wheel: Num) -> tuple[Bool, Bool]:
    """Whether a wheel is on channel A, and on channel B."""
    alone, end = config.alone_um, config.end_um
    return between(0, wheel, end - alone - 1), between(alone, wheel, end - 1)


def _world(config: CountingHeadConfig, truth: Truth, head: AxleHead) -> World:
    own, end = head.own, config.end_um
    (a_was, b_was), (a_late, b_late) = truth.damped, truth.late
    a, b = own.channel_a_damped, own.channel_b_damped
    on, then_on = between(0, own.wheel, end - 1), between(0, own.next_wheel, end - 1)
    on_a, on_b = _stretches(config, own.next_wheel)
    begins, left_above = ~a_was & ~b_was & (a | b), own.next_wheel >= end
    comes, leaves = ~on & then_on, on & ~then_on
    passes = leaves & own.from_low.iff(left_above)
    late_a, late_b = a & ~on_a, b & ~on_b
    ran = truth.ran + ite(truth.up, truth.run, -truth.run)
    entered = ite(own.wheel < 0, own.next_wheel, -own.next_wheel + (end - 1))
    before = ite(~a_was & ~b_was, Lit(0, COUNT), truth.gone)
    one = own.next_wheel - own.wheel
    swapped = ~on & ~then_on & ((~a_was & ~b_was) | (truth.gone > 0))
    same_train = a | b | a_was | b_was
    return World(
        ghosts={
            **own.declared.ghosts, truth.speed: ANY, truth.ran: 0, truth.up: False, truth.gone: 0,
            a_was: False, b_was: False, a_late: False, b_late: False,
        },
        choices=[*own.declared.choices, truth.next_speed, truth.run],
        moves={
            own.wheel: own.next_wheel,
            own.from_low: ite(comes, own.wheel < 0, own.from_low),
            own.passed: ite(passes, ite(own.from_low, UP, DOWN), NO_AXLE),
            truth.speed: truth.next_speed,
            truth.up: ite(begins, own.wheel < 0, truth.up),
            truth.ran: ite(begins, entered, maximum(minimum(ran, Lit(BESIDE_UM, UM)), Lit(-BESIDE_UM, UM))),
            truth.gone: minimum(before + ite(passes, Lit(1, COUNT), 0), Lit(2, COUNT)),
            a_was: a, b_was: b, a_late: late_a, b_late: late_b,
        },
        clauses={
            "a channel is damped by its wheel": on_a.implies(a) & on_b.implies(b),
            "a channel comes free late, and begins by its wheel": a.implies(on_a | a_was) & b.implies(on_b | b_was),
            "one channel at a time is late": ~(late_a & late_b),
            "the wheel nearest to the head runs with its train": swapped | one.eq(truth.run),
            "trains keep to traction and brakes": same_train.implies(
                abs_(truth.next_speed - truth.speed) <= Lit(change_um_s(config), UM_S)
            ),
            "a train runs as fast as it is": _runs(config, truth),
        },
    )  # fmt: skip


def _runs(config: CountingHeadConfig, truth: Truth) -> Bool:
    sample, rounding = Lit(config.head.sample_us, US), exact_to(Lit(1, UM), _PM)
    slow, fast = minimum(truth.speed, truth.next_speed), maximum(truth.speed, truth.next_speed)
    run = exact_to(truth.run, _PM)
    return (run > slow * sample - rounding) & (run < fast * sample + rounding)


# ------------------------------------------------------------------ what helps to prove


class Terms:
    """Terms of one state of the whole, named as in the machines and in `Truth`."""

    def __init__(self, whole: LateChannel) -> None:
        head, cycle = (whole.composition.of(one.machine) for one in (whole.head, whole.cycle))
        own, counts, truth = whole.head.own, whole.cycle.own, whole.truth
        self.modes = whole.head.machine.modes
        self.head_mode, self.mode = head.num(whole.head.machine.mode), cycle.num(counts.mode_before)
        self.alone, self.since, self.flawed = (
            cycle.num(counts.first_alone), cycle.num(counts.since_both), cycle.bool(counts.flawed),
        )  # fmt: skip
        self.axle, self.wheel, self.from_low, self.passed = (
            head.num(own.axle), head.num(own.wheel), head.bool(own.from_low), head.num(own.passed),
        )  # fmt: skip
        self.speed, self.ran, self.gone, self.up = (
            head.num(truth.speed), head.num(truth.ran), head.num(truth.gone), head.bool(truth.up),
        )  # fmt: skip
        self.a, self.b = (head.bool(one) for one in truth.damped)
        self.late_a, self.late_b = (head.bool(one) for one in truth.late)
        self.even = self.alone < whole.config.wheel.slow_samples
        self.ahead = ite(self.up, self.speed, -self.speed)

    def first(self) -> Bool:
        """One channel alone is damped, the one that the wheel came to first."""
        return self.mode.one_of(self.modes[1], self.modes[4])

    def both(self) -> Bool:
        return self.mode.one_of(self.modes[2], self.modes[5])

    def last(self) -> Bool:
        """The second channel alone is damped."""
        return self.mode.one_of(self.modes[3], self.modes[6])


def _lemmas(whole: LateChannel) -> Iterator[tuple[str, Bool]]:
    of = Terms(whole)
    yield "the mode is the head's", of.mode.eq(of.head_mode)
    yield "the mode is how the channels are damped", _channels(of)
    yield "a late channel is damped where no wheel is", _late(whole, of)
    yield "the first wheel is where it has run to", _followed(whole, of)
    yield "an even wheel", _even(whole, of)
    yield "it is fast if soon on both channels", all_of(_fast(whole.config, of))
    yield "it runs on as fast", all_of(_runs_on(whole.config, of))


def _channels(of: Terms) -> Bool:
    free, a_first, both_up, b_last, b_first, both_down, a_last, disturbed = of.modes
    mode, a, b = of.mode, of.a, of.b
    return all_of([
        mode.eq(free).implies(~a & ~b),
        mode.one_of(a_first, a_last).implies(a & ~b),
        mode.one_of(b_first, b_last).implies(b & ~a),
        mode.one_of(both_up, both_down).implies(a & b),
        (mode.one_of(a_first, both_up, b_last) & of.even).implies(of.up),
        (mode.one_of(b_first, both_down, a_last) & of.even).implies(~of.up),
        (mode.eq(free) | of.first()).implies(of.since.eq(0)),
        mode.eq(free).implies(of.alone.eq(0)),
        (~a & ~b).implies(mode.one_of(free, disturbed)),
        mode.ne(free).implies(of.axle.eq(NO_AXLE)),
    ])  # fmt: skip


def _late(whole: LateChannel, of: Terms) -> Bool:
    on_a, on_b = _stretches(whole.config, of.wheel)
    truthful = on_a.implies(of.a) & on_b.implies(of.b)
    alone = ~(of.late_a & of.late_b) & (of.a & ~on_a).implies(of.late_a) & (of.b & ~on_b).implies(of.late_b)
    return truthful & alone


def _followed(whole: LateChannel, of: Terms) -> Bool:
    """As long as no wheel has passed, the nearest one is that which has come on the head, and has not left it upwards."""
    end, damped = whole.config.end_um, of.a | of.b
    place = ite(of.up, of.wheel, -of.wheel + (end - 1))
    on = between(0, of.wheel, end - 1)
    here = of.ran.eq(place) & (of.ran < end) & on.implies(of.from_low.iff(of.up))
    return (damped & of.gone.eq(0)).implies(here)


def _even(whole: LateChannel, of: Terms) -> Bool:
    """A wheel that has not gone back: on one channel, on both, and beyond them."""
    alone, end = whole.config.alone_um, whole.config.end_um
    on_a, on_b = _stretches(whole.config, of.wheel)
    on_first = ite(of.up, on_a, on_b)
    another = ~on_first & (on_a | on_b).implies(of.from_low.iff(~of.up))
    step = whole.config.head.max_speed_mm_s * UM_PER_MM * whole.config.head.sample_us
    soon = exact_to(of.ran, _PM) < with_unit(of.alone * step, _PM)
    return of.even.implies(
        all_of([
            of.first().implies(of.gone.eq(0) & (of.ran < alone) & (of.alone > 0) & soon),
            of.both().implies(of.gone.eq(0)),
            of.last().implies((of.gone.eq(0)) | (of.gone.eq(1) & another)),
            (of.both() | of.last()).implies((of.since > 0) & (of.alone > 2)),
        ])
    ) & (
        of.last() & of.even & _timed(whole.config, of)
    ).implies(of.ran >= ite(of.gone.eq(0), Lit(end - alone, UM), Lit(end, UM)))  # fmt: skip


def _timed(config: CountingHeadConfig, of: Terms) -> Bool:
    """The wheel would be counted without a fault if the head were free now."""
    wheel = config.wheel
    return of.since <= of.alone * wheel.times_as_long + wheel.more_samples


def _at(config: CountingHeadConfig, samples: Num, speed_um_s: int) -> Num:
    """The run of so many samples at a speed, pm."""
    return with_unit(samples * (speed_um_s * config.head.sample_us), _PM)


def _slowest(config: CountingHeadConfig, most: int) -> int:
    return (config.alone_um * US_PER_S - 1) // ((most + 1) * config.head.sample_us) - config.unsure_um_s


def _fast(config: CountingHeadConfig, of: Terms) -> Iterator[Bool]:
    way, changed = exact_to(of.ran, _PM), with_unit(of.alone * config.change_um_s, UM_S)
    for above, most in late_spans(config):
        slow, fast = _slowest(config, most), came_um_s(config, above)
        near = (way <= _at(config, of.alone, slow + config.unsure_um_s)) | (of.ahead >= Lit(slow, UM_S) - changed)
        far = (way >= _at(config, of.alone - 1, fast - config.unsure_um_s)) | (of.ahead <= Lit(fast, UM_S) + changed)
        yield (of.first() & of.even).implies(near & far)


def _runs_on(config: CountingHeadConfig, of: Terms) -> Iterator[Bool]:
    wheel = config.wheel
    for above, most in late_spans(config):
        rest = wheel.times_as_long * most + wheel.more_samples
        changed = with_unit((of.since + most) * config.change_um_s, UM_S)
        slow, fast = Lit(_slowest(config, most), UM_S) - changed, Lit(came_um_s(config, above), UM_S) + changed
        pace = pace_um_s(config, above, most)
        beyond = exact_to(of.ran - Lit(config.alone_um, UM), _PM) <= _at(config, of.since, pace)
        here = (of.both() | of.last()) & (of.alone > above) & (of.alone <= most) & (of.since <= rest)
        yield here.implies((of.ahead >= slow) & (of.ahead <= fast) & (of.ran >= config.alone_um) & beyond)


# ------------------------------------------------------------------ claims


def claims(whole: LateChannel, late_mm: int) -> list[Property]:
    """What is counted without a fault is one wheel, in its direction, and no farther on than the figure."""
    of, end = Terms(whole), whole.config.end_um
    counted = of.axle.ne(NO_AXLE) & ~of.flawed
    became_free = of.mode.eq(of.modes[0]) & earlier_num(of.mode).ne(of.modes[0])
    terms: dict[str, Bool] = {
        "one wheel is counted": counted.implies(of.gone.eq(1)),
        "in its direction": counted.implies(of.axle.eq(ite(of.up, UP, DOWN))),
        "when it has left the head": counted.implies(of.ran >= end),
        "and no farther on": counted.implies(of.ran < end + late_mm * UM_PER_MM),
        "a wheel that passes is counted, or a fault, or the head stays damped": of.passed.ne(NO_AXLE).implies(
            counted | of.flawed | (of.mode.ne(of.modes[0]) & of.gone.ne(0))
        ),
        "a wheel that is not counted is a fault": (became_free & of.axle.eq(NO_AXLE)).implies(of.flawed),
    }
    return [
        always(name, term, statement=name, requirements=("FVA-4", "FVA-13"), assumption="a channel comes free late")
        for name, term in terms.items()
    ]
