"""Configurations in which odometry is proved beside its defaults, so that no case of it stays folded away."""

from __future__ import annotations

from safeloc.config import Configurations
from safeloc.models.odometry.variables import OdometryConfig
from safeloc.models.vocabulary.error_law import ACCELEROMETER, EDDY_CURRENT

NEVER = {
    "models/odometry/__init__.py: ite(state.alive, state.age, 0) from _becomes(device, nothing(device))": "a device without a position: the row says so",
    "models/odometry/__init__.py: ite(state.alive, state.run, 0) from _becomes(device, nothing(device))": "a device without a position: the row says so",
    "models/odometry/__init__.py: ite(values.alive, values.above, 0) from _becomes(device, nothing(device))": "a device without a position: the row says so",
    "models/odometry/__init__.py: ite(values.alive, values.below, 0) from _becomes(device, nothing(device))": "a device without a position: the row says so",
    "models/odometry/__init__.py: ite(values.alive, values.position, 0) from _becomes(device, nothing(device))": "a device without a position: the row says so",
    "models/odometry/__init__.py: ite(state.alive, state.run, 0) from _becomes(one, fresh if one is reading.device else nothing(on ...": "by a position of satellites the vehicle has run nothing since: 0 on either side",
    "models/odometry/hidden_faults.py: not hidden": "a world with a fault that may hide is no shipped target: tests/models/test_odometry_faults.py proves it",
    "models/odometry/lemmas.py: as_num(0, NM).eq(0) from _set_no_earlier(own, index, device)": "true, of a unit that does not drift",
    "models/odometry/lemmas.py: half - unit.below - more from _inside(own, unit, checker, unseen)": "zero where no fault may hide",
    "models/odometry/lemmas.py: half - unit.below - more from _inside(own, unit, unit, as_num(0, NM))": "zero where no fault may hide",
    "models/odometry/lemmas.py: unit.above - half + more from _inside(own, unit, checker, unseen)": "zero where no fault may hide",
    "models/odometry/lemmas.py: unit.above - half + more from _inside(own, unit, unit, as_num(0, NM))": "zero where no fault may hide",
    "models/odometry/lemmas.py: own.ghosts.unseen": "a world with a fault that may hide is no shipped target: tests/models/test_odometry_faults.py proves it",
    "models/odometry/marker_reading.py: as_num(0, COUNT).eq(0) from own.pending.after( passed[0][0] | passed[1][0], first_of(*pa ...": "the first place of the list has none before it",
    "models/odometry/ghosts.py: with_fault and not covered": "a world with a fault that may hide is no shipped target: tests/models/test_odometry_faults.py proves it",
    "models/odometry/variables.py: length is None": "a vehicle whose length is an input belongs to the marker field: tests/theorems/odometry/marker_field.py, proved by tests/models",
    "models/odometry/variables.py: length is not None": "a vehicle whose length is an input belongs to the marker field: tests/theorems/odometry/marker_field.py, proved by tests/models",
    "models/odometry/world.py: own.length is None": "a vehicle whose length is an input belongs to the marker field: tests/theorems/odometry/marker_field.py, proved by tests/models",
    "models/vocabulary/vehicle_world.py: between(-farthest_nm, ran, farthest_nm) from speed_law(seen.true_cycle_distance, farthest)": "the choice has this range; the clause names it for the register of assumptions",
    "models/odometry/world.py: own.ghosts.faulty_unit is None or own.config.single_fault_sa ...": "a world with a fault that may hide is no shipped target: tests/models/test_odometry_faults.py proves it",
    "models/vocabulary/error_law.py: above * Lit(self.rate_ppm, PPM) + floor + drift from unit.law.portion(share_ppm).growth_nm(self.reach, self.age,  ...": "the law of a part of a cycle has no drift (ErrorLaw.portion)",
    "models/vocabulary/interval.py: self.above + both_sides_nm from self.widened(self.unseen_nm)": "a position of satellites is of the cycle's end: nothing was run since",
    "models/vocabulary/interval.py: self.below + both_sides_nm from self.widened(self.unseen_nm)": "a position of satellites is of the cycle's end: nothing was run since",
    'properties/odometry/__init__.py: machine.output("age_ms") <= config.age_limit_ms from maker(model)': "its sides are the bounds of the declared range: the claim is proved by the range obligation",
    "properties/odometry/faults.py: model.own.config.single_fault_safe": "a world with a fault that may hide is no shipped target: tests/models/test_odometry_faults.py proves it",
    "properties/odometry/faults.py: position + above + wider from all_of( machine.mode.eq(mode).implies( between(position - be ...": "zero where no fault may hide",
    "properties/odometry/faults.py: position - below - wider from all_of( machine.mode.eq(mode).implies( between(position - be ...": "zero where no fault may hide",
}
"""Case splits that no configuration makes live, and why."""
CONFIGURATIONS = Configurations(
    {
        "one device, the first marker is believed": OdometryConfig(devices=1, trust_first_marker=True),
        "safe against a single fault": OdometryConfig(single_fault_safe=True, tolerance_mm=45_000),
        "the second unit drifts": OdometryConfig(first_unit=EDDY_CURRENT, second_unit=ACCELEROMETER),
        "the first unit drifts, one device": OdometryConfig(
            devices=1, first_unit=ACCELEROMETER, second_unit=EDDY_CURRENT
        ),
        "positions of satellites serve as markers": OdometryConfig(satellite_markers=True),
        "satellites, the second unit drifts": OdometryConfig(
            first_unit=EDDY_CURRENT, second_unit=ACCELEROMETER, satellite_markers=True
        ),
        "satellites, units that drift, one device, the first reference is believed": OdometryConfig(
            devices=1,
            first_unit=EDDY_CURRENT,
            second_unit=ACCELEROMETER,
            satellite_markers=True,
            trust_first_marker=True,
            single_fault_safe=True,
            tolerance_mm=45_000,
        ),
    },
    NEVER,
)
