"""Models of radar reflectors, and the greatest figures of an echo."""

from __future__ import annotations

from safeloc.language.expr import members

MODEL = members("reflector_model", "NONE", "A", "B", "C", "D", "E", "F", "G", "H")
"""Models by which the signal front end distinguishes reflectors (RFL-10); NONE: no known signature."""
NO_MODEL = MODEL[0]
MAX_ERROR_MM = 100_000
LATERAL_LIMIT_MM = 100_000
