"""Small machines that together use every feature of the language; every back end and every prover runs them all.

Each comes with a property that holds and one that fails after a known number of steps.
"""

from __future__ import annotations

from dataclasses import dataclass

from safeloc.language.composition import compose
from safeloc.language.expr import (
    Expr,
    Lit,
    NumVar,
    Var,
    abs_,
    as_num,
    before,
    between,
    boolean,
    ceil_to,
    choice,
    enumeration,
    exact_to,
    floor_div,
    floor_to,
    ite,
    maximum,
    members,
    minimum,
    number,
    optional,
    product,
    was,
)
from safeloc.language.machine import ANY, Machine, Transition, current_mode, modes
from safeloc.language.nodes import Value
from safeloc.language.spec import Property, always, never, once, previous, since, within
from safeloc.language.system import TransitionSystem, lower
from safeloc.language.units import CM, COUNT, MM, MM_S, MS, NM, PPM, UM
from safeloc.language.world import World


@dataclass(frozen=True, eq=False)
class Example:
    """A system with what holds and what fails of it; `fails_depth` is the least number of steps to the violation."""

    name: str
    system: TransitionSystem
    machines: tuple[Machine, ...]
    holds: Property
    fails: Property
    fails_depth: int


def single(machine: Machine, holds: Property, fails: Property, fails_depth: int) -> Example:
    """An example of one machine."""
    return Example(machine.name, lower(machine), (machine,), holds, fails, fails_depth)


LINE_MM = 10**6
WORLD_NM = 10**13
RATE = Lit(50_000, PPM)


@dataclass(frozen=True, eq=False)
class Odometer:
    """The odometer with the variables that its properties read."""

    machine: Machine
    position: NumVar
    margin: NumVar
    truth: NumVar


def build_odometer(tolerance_mm: int, *, judged_late: bool = False) -> Odometer:
    """Distance run since the last reference, its margin (5 % of the way), and the truth beside it.

    `judged_late` is a deliberate fault: the tolerance is compared with the margin before the step.
    """
    tracking, delocalized = table = modes("TRACKING", "DELOCALIZED")
    mode, tolerance_nm = current_mode(table), tolerance_mm * 10**6
    movement, reference = number("movement", MM, -5000, 5000), optional("reference", MM, 0, LINE_MM)
    position = number("position", MM, -LINE_MM, LINE_MM)
    margin = number("margin", NM, 0, tolerance_nm + 5000 * 50_000)
    truth, moved = number("truth", NM, -WORLD_NM, WORLD_NM), number("moved", NM, -(10**10), 10**10)
    grown = margin + abs_(movement) * RATE
    arrived, error = truth + moved, abs_(truth - exact_to(position, NM))
    machine = Machine(
        name="late_odometer" if judged_late else "odometer",
        modes=table,
        inputs=[movement, reference],
        state={position: 0, margin: 0},
        outputs={"position_mm": position, "margin_mm": ceil_to(margin, MM), "valid": mode.eq(tracking)},
        transitions=[
            Transition("reference", table, tracking, reference.present, {position: reference.value, margin: 0}),
            Transition(
                "tolerance exceeded", tracking, delocalized, (margin if judged_late else grown) > tolerance_nm, rank=1
            ),
            Transition("line left", tracking, delocalized, ~between(-LINE_MM, position + movement, LINE_MM), rank=2),
            Transition("run on", tracking, tracking, set={position: position + movement, margin: grown}, rank=3),
        ],
        world=World(
            ghosts={truth: 0},
            choices=[moved],
            moves={truth: arrived},
            clauses={
                "assumption": (abs_(moved - exact_to(movement, NM)) <= abs_(movement) * RATE)
                & reference.present.implies(exact_to(reference.value, NM).eq(arrived))
                & between(-WORLD_NM, arrived, WORLD_NM)
            },
        ),
        lemmas={"truth within margin": mode.eq(tracking).implies(error <= margin)},
    )
    return Odometer(machine, position, margin, truth)


def odometer() -> Example:
    """Optional input, ghosts with an assumption, a lemma; the margin is seen to grow."""
    built = build_odometer(tolerance_mm=1000)
    machine, margin = built.machine, built.margin
    error = abs_(built.truth - exact_to(built.position, NM))
    contained = machine.flag("valid").implies(error <= exact_to(machine.output("margin_mm"), NM))
    return single(machine, always("containment", contained), always("small margin", margin <= 900 * 10**6), 4)


def late_odometer() -> Example:
    """The same with its deliberate fault: the tolerance is exceeded before the machine notices."""
    built = build_odometer(tolerance_mm=2000, judged_late=True)
    machine, margin = built.machine, built.margin
    tolerated = machine.flag("valid").implies(margin <= 2000 * 10**6)
    shrunk = never("margin shrinks without a reference", (margin < before(margin)) & ~machine.fired("reference"))
    return single(machine, shrunk, always("tolerance", tolerated), 9)


def doors() -> Example:
    """Enumerated and boolean inputs, ranks, a boolean state variable, `was` and `fired`."""
    closed, moving, open_ = table = modes("CLOSED", "MOVING", "OPEN")
    nothing, to_open, to_close = commands = members("command", "NOTHING", "TO_OPEN", "TO_CLOSE")
    command, obstructed = choice("command", enumeration(commands)), boolean("obstructed")
    speed, warned = number("speed", MM_S, 0, 20_000), boolean("warned")
    still = speed.eq(0)
    machine = Machine(
        name="doors",
        modes=table,
        inputs=[command, obstructed, speed],
        state={warned: False},
        outputs={"locked": ~warned},
        transitions=[
            Transition("obstructed", moving, open_, obstructed, {warned: True}),
            Transition("open", closed, moving, command.eq(to_open) & still, {warned: True}, rank=1),
            Transition("opened", moving, open_, command.eq(to_open) & still, rank=1),
            Transition("close", open_, moving, command.eq(to_close), rank=1),
            Transition("closed", moving, closed, command.one_of(to_close, nothing), {warned: obstructed}, rank=1),
        ],
    )
    opened_running = never("opened while running", machine.fired("open") & ~still)
    return single(machine, opened_running, never("open twice", machine.mode.eq(open_) & was(warned) & obstructed), 2)


def rounding() -> Example:
    """Rounding down and up, also below zero; min, max and abs."""
    (measuring,) = table = modes("MEASURING")
    raw = number("raw", MM, -1000, 1000)
    low, high, widest = number("low", CM, -101, 101), number("high", CM, -101, 101), number("widest", CM, 0, 1)
    down, up = floor_to(raw, CM), ceil_to(raw, CM)
    machine = Machine(
        name="rounding",
        modes=table,
        inputs=[raw],
        state={low: 0, high: 0, widest: 0},
        outputs={"low_mm": exact_to(low, MM), "third_mm": floor_div(minimum(exact_to(low, MM), 7) - 100, 3)},
        transitions=[
            Transition("measure", measuring, measuring, set={low: down, high: up, widest: maximum(widest, up - down)})
        ],
    )
    around = between(machine.output("low_mm"), raw, exact_to(high, MM)) & (abs_(raw) <= exact_to(abs_(low) + 1, MM))
    return single(machine, always("rounded outward", around), always("exact", low.eq(high)), 1)


def braking() -> Example:
    """A declared product of two variables."""
    running, stopped = table = modes("RUNNING", "STOPPED")
    speed, duration = number("speed", MM_S, 0, 100), number("duration", MS, 0, 50)
    way = number("way", UM, 0, 20_000)
    run = way + product(speed, duration)
    machine = Machine(
        name="braking",
        modes=table,
        inputs=[speed, duration],
        state={way: 0},
        outputs={"way_mm": floor_to(way, MM)},
        transitions=[
            Transition("stop", running, stopped, run > 20_000),
            Transition("run", running, running, set={way: run}, rank=1),
        ],
    )
    forward = always("never backwards", before(way) <= way)
    return single(machine, forward, always("short", way <= 9_999), 2)


def timer() -> Example:
    """An open first value restricted by `initially`, and `within`."""
    waiting, elapsed = table = modes("WAITING", "ELAPSED")
    left, restart = number("left", COUNT, 0, 5), boolean("restart")
    machine = Machine(
        name="timer",
        modes=table,
        inputs=[restart],
        state={left: ANY},
        outputs={"left": left},
        transitions=[
            Transition("restart", table, waiting, restart, {left: 3}),
            Transition("elapse", waiting, elapsed, left <= 1, {left: 0}, rank=1),
            Transition("tick", waiting, waiting, set={left: left - 1}, rank=2),
        ],
        initially=left >= 2,
    )
    ticked, done = machine.fired("tick"), machine.mode.eq(elapsed)
    counted_down = within(
        "elapses or restarts", 4, ticked, done | restart, helper=lambda waited: (waited > 0).implies(left + waited <= 5)
    )
    return single(machine, counted_down, within("elapses at once", 1, ticked, done), 2)


def latch() -> Example:
    """Only truth values, a chain of choices among them, and the past operators."""
    (on,) = table = modes("ON")
    alarm, cleared, seen, twice = boolean("alarm"), boolean("cleared"), boolean("seen"), boolean("twice")
    machine = Machine(
        name="latch",
        modes=table,
        inputs=[alarm, cleared],
        state={seen: False, twice: False},
        outputs={"shown": ite(twice, seen, ~seen)},
        transitions=[
            Transition("clear", on, on, cleared & ~alarm, {seen: False, twice: seen & twice}),
            Transition("alarm", on, on, alarm, {seen: True, twice: seen.iff(~twice)}, rank=1),
        ],
    )
    remembered = seen.iff(since(~machine.fired("clear"), machine.fired("alarm"))) & seen.implies(once(alarm))
    return single(machine, always("remembered", remembered), never("back to back", previous(alarm) & twice & seen), 2)


def priorities() -> Example:
    """Overlapping guards of different rank, several updates a row, and a value that saturates both ways."""
    low, high = table = modes("LOW", "HIGH")
    change, level, flips = number("change", COUNT, -9, 9), number("level", COUNT, -20, 20), number("flips", COUNT, 0, 3)
    moved = maximum(minimum(level + change, as_num(20, COUNT)), -20)
    flipped: dict[Var, Expr | Value] = {level: moved, flips: ite(flips.eq(3), flips, flips + 1)}
    machine = Machine(
        name="priorities",
        modes=table,
        inputs=[change],
        state={level: 0, flips: 0},
        outputs={"doubled": level * 2},
        transitions=[
            Transition("rise", low, high, moved > 10, flipped),
            Transition("fall", high, low, moved < -10, flipped),
            Transition("big move", table, low, abs_(change) > 7, {level: moved}, rank=1),
            Transition("move", table, high, change.ne(0), {level: moved}, rank=2),
        ],
    )
    counted = always("flips are counted", machine.fired("rise", "fall").implies(flips >= 1))
    return single(machine, counted, never("three flips", flips.eq(3)), 6)


def alarm_chain() -> Example:
    """Two machines, output wired to input: the second one sees the fault in the step in which it is found."""
    healthy, faulty = states = modes("HEALTHY", "FAULTY")
    judged = current_mode(states)
    value, bad = number("value", COUNT, 0, 9), number("bad", COUNT, 0, 3)
    judge = Machine(
        name="judge",
        modes=states,
        inputs=[value],
        state={bad: 0},
        outputs={"bad": bad},
        transitions=[
            Transition("third bad value", healthy, faulty, (value > 7) & (bad >= 2), {bad: 3}),
            Transition("bad value", healthy, healthy, value > 7, {bad: bad + 1}, rank=1),
            Transition("good value", healthy, healthy, value <= 7, {bad: 0}, rank=1),
            Transition("recovered", faulty, healthy, value.eq(0), {bad: 0}, rank=1),
        ],
        lemmas={"three bad values": judged.eq(faulty).iff(bad.eq(3))},
    )
    free, braked = actions = modes("FREE", "BRAKED")
    count, released = number("count", COUNT, 0, 3), boolean("released")
    brake = Machine(
        name="brake",
        modes=actions,
        inputs=[count, released],
        state={},
        outputs={},
        transitions=[
            Transition("brake", free, braked, count >= 3),
            Transition("release", braked, free, released & (count < 3), rank=1),
        ],
    )
    whole = compose("alarm_chain", [judge, brake], {count: judge.output("bad")})
    faulted = whole.of(judge).bool(judge.mode.eq(faulty))
    is_braked = whole.of(brake).bool(brake.mode.eq(braked))
    holds = always("braked in the same step", faulted.implies(is_braked))
    return Example("alarm_chain", whole.system, (judge, brake), holds, never("brakes", is_braked), 3)


def answered_alarm() -> Example:
    """Two machines that hear each other: the first one hears a step late that the second one brakes, and how often it did."""
    healthy, faulty = states = modes("HEALTHY", "FAULTY")
    value, bad = number("value", COUNT, 0, 9), number("bad", COUNT, 0, 3)
    heard, heard_times = boolean("heard"), number("heard_times", COUNT, 0, 5)
    judge = Machine(
        name="judge",
        modes=states,
        inputs=[value, heard, heard_times],
        state={bad: 0},
        outputs={"bad": bad},
        transitions=[
            Transition("third bad value", healthy, faulty, (value > 7) & (bad >= 2), {bad: 3}),
            Transition("bad value", healthy, healthy, value > 7, {bad: bad + 1}, rank=1),
            Transition("good value", healthy, healthy, value <= 7, {bad: 0}, rank=1),
            Transition("answered", faulty, healthy, heard & heard_times.eq(2), {bad: 0}, rank=1),
        ],
    )
    free, braked = actions = modes("FREE", "BRAKED")
    count, times = number("count", COUNT, 0, 3), number("times", COUNT, 0, 3)
    brake = Machine(
        name="brake",
        modes=actions,
        inputs=[count],
        state={times: 0},
        outputs={"times": times},
        transitions=[
            Transition("brake", free, braked, count >= 3, {times: minimum(times + 1, as_num(3, COUNT))}),
            Transition("release", braked, free, count < 3, rank=1),
        ],
    )
    wires: dict[Var, Expr] = {
        count: judge.output("bad"), heard: before(brake.mode).eq(braked), heard_times: before(times) + 1,
    }  # fmt: skip
    whole = compose("answered_alarm", [judge, brake], wires)
    of_judge, of_brake = whole.of(judge), whole.of(brake)
    answered, mode, number_ = of_judge.bool(judge.fired("answered")), of_brake.num(brake.mode), of_brake.num(times)
    assert isinstance(mode, NumVar) and isinstance(number_, NumVar)
    told = of_judge.bool(heard) & of_judge.num(heard_times).eq(before(number_) + 1)
    holds = always("answered only by a brake", answered.implies(told & before(mode).eq(braked)))
    return Example("answered_alarm", whole.system, (judge, brake), holds, never("answers", answered), 4)


EXAMPLES = (
    odometer(),
    late_odometer(),
    doors(),
    rounding(),
    braking(),
    timer(),
    latch(),
    priorities(),
    alarm_chain(),
    answered_alarm(),
)
