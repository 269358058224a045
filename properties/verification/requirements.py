"""The requirements that the claims of the verification answer for: entries of the two publications, in pairs."""

from __future__ import annotations

CLAIM = ("FVA-1", "FVA-10")
STAY = ("FVA-2", "FVA-11")
ENTRY = ("FVA-3", "FVA-12")
MATCH = ("FVA-4", "FVA-13")
COUNTED = (*MATCH, "FVA-5", "FVA-14")
COURSE = ("FVA-6", "FVA-15")
CONTROL = ("FVA-7", "FVA-16")
EMITTER = ("FVA-8", "FVA-17")
