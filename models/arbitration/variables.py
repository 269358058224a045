"""Configuration and variables of the arbitration machine: what each way of locating states, and what is kept."""

from __future__ import annotations

from dataclasses import dataclass

from pydantic import Field, model_validator

from safeloc.config import Config, quantity
from safeloc.language.declared import Declared
from safeloc.language.expr import (
    Bool,
    BoolVar,
    Num,
    NumVar,
    Var,
    boolean,
    choice,
    enumeration,
    maximum,
    members,
    number,
    optional,
)
from safeloc.language.machine import ANY
from safeloc.language.units import MM, NM, NM_PER_MM
from safeloc.models.vocabulary.reasons import NO_REFERENCE, REASON
from safeloc.models.vocabulary.vehicle_world import stated_interval_holds

SOURCES = ("odometry", "balise", "reflector", "satellite", "fibre")


class ArbitrationConfig(Config):
    """Names of the sources, and the tolerable errors."""

    sources: tuple[str, ...] = SOURCES
    own: tuple[str, ...] = Field(default=(), description="sources of your own, after these")
    tolerance_mm: int = quantity(30_000, "mm", 1, 500_000, "[S] OCORA 7239: 30 m on main line")
    max_cycle_distance_mm: int = quantity(4_459, "mm", 1, 200_000, "[D] 160 km/h in 100 ms, and a measuring step")
    lag_limit_mm: int = quantity(
        1_000_000, "mm", 0, 10_000_000, "[D] farther, odometer and sources contradict each other"
    )
    position_limit_mm: int = quantity(1_000_000_000, "mm", 1_000, 10_000_000_000, "[D] 1 000 km of line")

    @model_validator(mode="after")
    def _known_sources(self) -> ArbitrationConfig:
        unknown = [name for name in self.sources if name not in SOURCES]
        if unknown or len(set(self.sources)) != len(self.sources) or not self.every:
            raise ValueError(f"sources {list(self.sources)} must be some of {list(SOURCES)}, each at most once.")
        taken = [name for name in self.own if name in (*SOURCES, "none", "withheld") or not name.isidentifier()]
        if taken or len({name.upper() for name in self.own}) != len(self.own):
            raise ValueError(f"own {list(self.own)} must be names of their own, each once, none of {list(SOURCES)}.")
        return self

    @property
    def every(self) -> tuple[str, ...]:
        """All sources, in the order in which they are declared."""
        return (*self.sources, *self.own)


@dataclass(frozen=True, eq=False)
class Source:
    """Inputs from one source in a cycle.

    valid       it states an interval, and may: trusted, current, within its own limits
    reference   it has accepted an absolute reference in this cycle
    reason      why it states nothing
    """

    name: str
    valid: BoolVar
    position: NumVar
    below: NumVar
    above: NumVar
    reference: BoolVar
    reason: NumVar

    @property
    def inputs(self) -> tuple[Var, ...]:
        """All of them, as inputs."""
        return self.valid, self.position, self.below, self.above, self.reference, self.reason

    @property
    def low(self) -> Num:
        """Min safe front end."""
        return self.position - self.below

    @property
    def high(self) -> Num:
        """Max safe front end."""
        return self.position + self.above

    @property
    def margin(self) -> Num:
        """The greater of both sides."""
        return maximum(self.below, self.above)

    def holds(self, truth: Num) -> Bool:
        """Return whether the source's interval contains the true position."""
        return stated_interval_holds(self.position, self.below, self.above, truth)


class Parts:
    """The variables of the machine.

    distance                input: the distance measured in the cycle
    position, below, above  the common interval; 0 while nothing is reported, and not shown then
    lag                     how far the min safe front end lies behind the interval's lower end
    first, second           two sources that exclude each other; NONE: none
    truth, next_truth       ghosts: the front end, nm
    """

    def __init__(self, config: ArbitrationConfig) -> None:
        self.declared = declared = Declared()
        limit, widest = config.position_limit_mm, 10 * config.tolerance_mm
        reach = (limit + 2 * widest) * NM_PER_MM
        named = enumeration(members("source", "NONE", *(name.upper() for name in config.every)))
        self.config = config
        self.distance = declared.sensor(
            optional("distance_mm", MM, -config.max_cycle_distance_mm, config.max_cycle_distance_mm)
        )
        self.position = declared.state(number("common_position_mm", MM, -limit, limit), first=0)
        self.below = declared.state(number("common_margin_below_mm", MM, 0, config.tolerance_mm), first=0)
        self.above = declared.state(number("common_margin_above_mm", MM, 0, config.tolerance_mm), first=0)
        self.lag = declared.state(number("lag_mm", MM, 0, config.lag_limit_mm), first=0)
        self.first = declared.state(choice("contradicting_first", named), first=0)
        self.second = declared.state(choice("contradicting_second", named), first=0)
        self.reason = declared.state(choice("reason", enumeration(REASON)), first=NO_REFERENCE)
        self.reference_taken = declared.state(boolean("reference_taken"), first=False)
        self.truth = declared.ghost(number("truth_nm", NM, -reach, reach), first=ANY)
        self.next_truth = declared.choice(number("next_truth_nm", NM, -reach, reach))
        self.sources = tuple(_source(declared, name, config) for name in config.every)
        self.named = named


def parts(config: ArbitrationConfig) -> Parts:
    """Return fresh variables for one vehicle."""
    return Parts(config)


def _source(declared: Declared, name: str, config: ArbitrationConfig) -> Source:
    limit, widest = config.position_limit_mm, 10 * config.tolerance_mm
    return Source(
        name,
        declared.sensor(boolean(f"{name}_valid")),
        declared.sensor(number(f"{name}_position_mm", MM, -limit, limit)),
        declared.sensor(number(f"{name}_margin_below_mm", MM, 0, widest)),
        declared.sensor(number(f"{name}_margin_above_mm", MM, 0, widest)),
        declared.sensor(boolean(f"{name}_reference")),
        declared.sensor(choice(f"{name}_reason", enumeration(REASON))),
    )
