"""Ultra-wideband beacons as a source of the localizer: `safeloc verify localizer --source beacons.py:source`.

A tag at the front end measures the range to a beacon ahead, whose place the map has. Between two ranges the interval
grows by what the vehicle can run.
"""

from safeloc.language.declared import Declared
from safeloc.language.expr import Bool, Num, exact_to, ite, maximum, minimum, number, optional
from safeloc.language.machine import Machine, Transition, current_mode, modes
from safeloc.language.units import MM, NM
from safeloc.language.world import Law
from safeloc.models.localizer import Vehicle
from safeloc.models.vocabulary.absent import margin_if, position_if
from safeloc.models.vocabulary.reasons import LOCATED, SENSOR_FAILURE

SURVEY_MM, RANGING_MM, WIDEST_MM = 100, 300, 45_000
TRUE_RANGE = (
    "The beacon's place less the range is where the front end was in the cycle, within survey and ranging error."
)


def holds(middle: Num, error: Num | int, low: Num, high: Num) -> Bool:
    """A place no farther from the middle than the error lies between low and high."""
    return (exact_to(middle - error, NM) <= high) & (exact_to(middle + error, NM) >= low)


def source(vehicle: Vehicle) -> Machine:
    """The beacons' machine for a vehicle."""
    far, run, declared = vehicle.position_limit_mm, vehicle.farthest_mm, Declared()
    beacon = declared.sensor(optional("beacon_mm", MM, 500_000 - far, far))
    distance = declared.sensor(optional("range_mm", MM, 0, 500_000))
    position = declared.state(number("place_mm", MM, -far, far), first=0)
    margin = declared.state(number("error_mm", MM, 0, WIDEST_MM), first=0)
    silent, located = table = modes("SILENT", "LOCATED")
    mode, fresh = current_mode(table), SURVEY_MM + RANGING_MM + run
    valid, ranged, place = mode.eq(located), beacon.present & distance.present, beacon.value - distance.value
    before, after = vehicle.truth, vehicle.truth_after
    near = holds(place, 400, minimum(before, after), maximum(before, after))
    law, wider = Law(ranged.implies(near), TRUE_RANGE, owner="supplier", source="[M]"), margin + run
    return Machine(
        name="beacons",
        modes=table,
        inputs=declared.inputs,
        state=declared.states,
        transitions=[
            Transition("range", table, located, ranged, {position: place, margin: fresh}),
            Transition("run on", located, located, wider <= WIDEST_MM, {margin: wider}, rank=1),
            Transition("too wide", located, silent, set={position: 0, margin: 0}, rank=2),
            Transition("no beacon yet", silent, silent, rank=2),
        ],
        outputs={
            "valid": valid,
            "position_mm": position_if(valid, position),
            **{f"margin_{side}_mm": margin_if(valid, margin) for side in ("below", "above")},
            "reference_accepted": valid & margin.eq(fresh),
            "reason": ite(valid, LOCATED, SENSOR_FAILURE),
        },
        world=vehicle.world({"a range is true": law}),
        lemmas={"the interval holds the front end": valid.implies(holds(position, margin, before, before))},
    )
