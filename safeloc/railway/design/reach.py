"""The greatest distances of two references on the map, by the audit's rule, and what the balise machine is proved to hold.

The run between two readings may be longer than the distance on the map: each group may lie its location accuracy off, and is read
within the detection accuracy. The machine has to hold its position over that run, so both come off its bound.
"""

from __future__ import annotations

from bisect import bisect_left
from dataclasses import dataclass
from functools import cached_property

from safeloc.models.balise.variables import BaliseConfig
from safeloc.models.layout_rules import LayoutConfig
from safeloc.models.line_runs.configs import LineVehicle, fitting
from safeloc.railway.audit.rules import Rules
from safeloc.railway.audit.stretches import fix_error_mm, longest
from safeloc.railway.design.held_stretch import HeldStretch, held_stretch
from safeloc.railway.map.elements import BaliseGroup
from safeloc.railway.map.walk import Reference

_FARTHEST_MM = 1_000_000
"""Beyond it no rule asks for more distance to a joint."""


@dataclass(frozen=True)
class Limit:
    """The greatest distance on the map from where one reference is read last to where the next one is read first, and what limits it."""

    distance_mm: int
    why: str


_Alike = tuple[str, int | None]


def kind_of_reach(element: Reference | None) -> _Alike:
    """Return what the limits depend on: the kind of the element, and a group's own location accuracy."""
    if isinstance(element, BaliseGroup):
        return "group", element.location_accuracy_mm
    return "edge" if element is None else "reflector", None


@dataclass(frozen=True, eq=False)
class Reach:
    """The limits for one vehicle's figures. Origin and goal may be None: the edge of the map."""

    layout: LayoutConfig

    @cached_property
    def config(self) -> BaliseConfig:
        """The configuration of the balise machine for the vehicle. InputError if its figures do not suit the machine."""
        found = fitting(LineVehicle(layout=self.layout, trust_first=True), "balise")
        assert isinstance(found, BaliseConfig)
        return found

    @cached_property
    def to_joint_mm(self) -> int:
        """The least distance from a group's last balise to a joint ahead that the audit permits."""
        rule = Rules(self.layout).group_before_joint
        return bisect_left(
            range(_FARTHEST_MM), True, key=lambda to_joint_mm: not rule.broken({"to_joint_mm": to_joint_mm})
        )

    @cached_property
    def _held(self) -> dict[int, HeldStretch | None]:
        return {}

    def held(self, accuracy_mm: int) -> HeldStretch | None:
        """Return the machine's bound after a group of that accuracy; None if no run is too long."""
        if accuracy_mm not in self._held:
            self._held[accuracy_mm] = held_stretch(self.config, accuracy_mm)
        return self._held[accuracy_mm]

    def accuracy_mm(self, group: BaliseGroup) -> int:
        """Return the location accuracy of a group: its own, or the national value."""
        own = group.location_accuracy_mm
        return self.layout.balise_accuracy_mm if own is None else own

    def _read_within_mm(self, element: Reference | None) -> int:
        """Return the distance from its place on the map within which a reference is read, which is the error of a fix by it."""
        return 0 if element is None else fix_error_mm(element, self.layout)

    def limit(self, origin: Reference | None, goal: Reference | None) -> Limit:
        """Return how far a goal may be from an origin."""
        key = kind_of_reach(origin), kind_of_reach(goal)
        if key not in self._limits:
            self._limits[key] = self._limit(origin, goal)
        return self._limits[key]

    @cached_property
    def _limits(self) -> dict[tuple[_Alike, _Alike], Limit]:
        return {}

    def _limit(self, origin: Reference | None, goal: Reference | None) -> Limit:
        fix, off = self._read_within_mm(origin), self._read_within_mm(origin) + self._read_within_mm(goal)
        kept = longest(fix, self.layout)
        law = f"{_metres(self.layout.odometry_constant_mm)} + {self.layout.odometry_rate_ppm / 10_000:g} %"
        why = f"odometry {law} after an error of {_metres(fix)}: the position is kept for {_metres(kept)} of true run"
        return Limit(
            kept - off, f"{why}, less {_metres(off)} by which the readings may be farther apart" if off else why
        )


def _metres(value_mm: int) -> str:
    return f"{value_mm / 1000:.3f} m"
