"""Reasons why a machine gives no position."""

from __future__ import annotations

from safeloc.language.expr import members

REASON = members("reason", "NONE", "NO_REFERENCE", "TOLERANCE", "SENSOR_FAILURE", "CONTRADICTION")
LOCATED, NO_REFERENCE, TOLERANCE, SENSOR_FAILURE, CONTRADICTION = REASON
