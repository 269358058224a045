"""Every variant of the odometry machine is proved, not only the default one."""

from __future__ import annotations

import pytest

from safeloc.language.system import lower
from safeloc.language.verdict import word
from safeloc.models.odometry import build
from safeloc.models.odometry.variables import OdometryConfig, parts
from safeloc.models.vocabulary.error_law import ACCELEROMETER, EDDY_CURRENT, OPTICAL
from safeloc.proof.provers.limits import Limits
from safeloc.proof.provers.portfolio import prove
from safeloc.properties.odometry import properties

VARIANTS = {
    "one device": OdometryConfig(devices=1),
    "single fault safe, first marker trusted": OdometryConfig(trust_first_marker=True, single_fault_safe=True),
    "accelerometer and eddy current": OdometryConfig(first_unit=EDDY_CURRENT, second_unit=ACCELEROMETER),
    "optical and eddy current": OdometryConfig(first_unit=OPTICAL, second_unit=EDDY_CURRENT, devices=1),
}

NEVER_REFUSED = {
    f"odometry/property/{end} reader over its marker is inside the window": "vacuous" for end in ("front", "rear")
}
EXCEPTIONS = {"single fault safe, first marker trusted": NEVER_REFUSED}
"""No reading is stray where the first marker is trusted, and with the worse law for each unit none is refused as out of its window."""


@pytest.mark.slow
@pytest.mark.parametrize("name", VARIANTS)
def test_variant_is_proved(name: str) -> None:
    """MRK-1, MRK-4: one or two devices, and units of every kind with their error laws."""
    model = build(parts(VARIANTS[name]))
    findings = prove(lower(model.machine), properties(model), Limits(seconds=30), jobs=2)
    assert {
        finding.id: word(finding.result) for finding in findings if word(finding.result) != "proved"
    } == EXCEPTIONS.get(name, {})
