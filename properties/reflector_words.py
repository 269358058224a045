"""Reasons of the reflector machine, in the words of the vehicle (RFL-D3): what its claims say wherever the machine is wired to a host."""

from __future__ import annotations

from collections.abc import Mapping

from safeloc.language.expr import Bool, Lit, Num
from safeloc.models.reflector import variables as reflecting
from safeloc.models.vocabulary.reasons import CONTRADICTION, NO_REFERENCE, SENSOR_FAILURE, TOLERANCE
from safeloc.properties.reason_words import in_words

_WORDS: Mapping[Lit, Lit] = {
    reflecting.NO_ERROR: NO_REFERENCE,
    reflecting.NO_POSITION: NO_REFERENCE,
    reflecting.TOLERANCE: TOLERANCE,
    reflecting.SENSOR_FAILURE: SENSOR_FAILURE,
    reflecting.NO_SELF_TEST: SENSOR_FAILURE,
}
"""Every other one is a contradiction."""


def says_why(reason: Num, error: Num) -> Bool:
    """Return whether the reason is that of the machine's error."""
    return in_words(reason, error, _WORDS) & (error.one_of(*_WORDS) | reason.eq(CONTRADICTION))
