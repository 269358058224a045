"""The variables of SUBSET-026 7.5 that the packets here consist of: bits, spare values, and lengths in mm.

A value is the whole number that is transmitted. `D_LINK` of 172 is 172 m where `Q_SCALE` says 1 m; `length_mm` says so.
"""

from __future__ import annotations

from collections.abc import Mapping, Set
from dataclasses import dataclass

from safeloc.errors import InputError

UNKNOWN_GROUP = 2**24 - 1
"""NID_LRBG, NID_PRVLRBG: no group is known."""
_GROUP_BITS = 14
UNKNOWN_LENGTH = 32_767
"""D_LRBG, L_DOUBTOVER and L_DOUBTUNDER: the value is unknown. D_VALIDNV: now."""
_SCALE_MM = {0: 100, 1: 1_000, 2: 10_000}
SPEED_STEP_KM_H, FASTEST_KM_H = 5, 600


@dataclass(frozen=True)
class Variable:
    """A variable: its number of bits, and the values that are spare: they must not be sent, and are refused."""

    bits: int
    spare: Set[int] = frozenset()


def _beyond(largest: int, bits: int) -> frozenset[int]:
    return frozenset(range(largest + 1, 2**bits))


VARIABLES: Mapping[str, Variable] = {
    # headers
    "NID_PACKET": Variable(8),
    "NID_MESSAGE": Variable(8),
    "L_PACKET": Variable(13),
    "L_MESSAGE": Variable(10),
    "T_TRAIN": Variable(32),
    "NID_ENGINE": Variable(24),
    "Q_DIR": Variable(2, frozenset({3})),
    "Q_SCALE": Variable(2, frozenset({3})),
    "N_ITER": Variable(5),
    "Q_UPDOWN": Variable(1),
    "M_VERSION": Variable(7),
    "Q_MEDIA": Variable(1),
    "N_PIG": Variable(3),
    "N_TOTAL": Variable(3),
    "M_DUP": Variable(2, frozenset({3})),
    "M_MCOUNT": Variable(8),
    "Q_LINK": Variable(1),
    # identities
    "NID_C": Variable(10),
    "NID_BG": Variable(14),
    "NID_LRBG": Variable(24),
    "NID_PRVLRBG": Variable(24),
    "NID_VBCMK": Variable(6),
    "NID_NTC": Variable(8),
    "NID_XUSER": Variable(9),
    # position report
    "D_LRBG": Variable(15),
    "Q_DIRLRBG": Variable(2, frozenset({3})),
    "Q_DLRBG": Variable(2, frozenset({3})),
    "L_DOUBTOVER": Variable(15),
    "L_DOUBTUNDER": Variable(15),
    "Q_LENGTH": Variable(2),
    "L_TRAININT": Variable(15),
    "V_TRAIN": Variable(7, _beyond(FASTEST_KM_H // SPEED_STEP_KM_H, 7)),
    "Q_DIRTRAIN": Variable(2, frozenset({3})),
    "M_MODE": Variable(4),
    "M_LEVEL": Variable(3, frozenset({5, 6, 7})),
    # linking
    "D_LINK": Variable(15),
    "Q_NEWCOUNTRY": Variable(1),
    "Q_LINKORIENTATION": Variable(1),
    "Q_LINKREACTION": Variable(2, frozenset({3})),
    "Q_LOCACC": Variable(6),
    # virtual balise cover
    "Q_VBCO": Variable(1),
    "T_VBC": Variable(8),
    # national values
    "D_VALIDNV": Variable(15),
    **{
        name: Variable(7, _beyond(120, 7))
        for name in (
            "V_NVSHUNT", "V_NVSTFF", "V_NVONSIGHT", "V_NVLIMSUPERV", "V_NVUNFIT", "V_NVREL", "V_NVALLOWOVTRP",
            "V_NVSUPOVTRP", "V_NVKVINT",
        )
    },
    **{name: Variable(15) for name in ("D_NVROLL", "D_NVOVTRP", "D_NVPOTRP", "D_NVSTFF")},
    **{
        name: Variable(1)
        for name in (
            "Q_NVSBTSMPERM", "Q_NVEMRRLS", "Q_NVGUIPERM", "Q_NVSBFBPERM", "Q_NVINHSMICPERM", "M_NVDERUN",
            "Q_NVDRIVER_ADHES", "Q_NVKINT",
        )
    },
    "T_NVOVTRP": Variable(8),
    "M_NVCONTACT": Variable(2, frozenset({3})),
    "T_NVCONTACT": Variable(8),
    **{name: Variable(6) for name in ("A_NVMAXREDADH1", "A_NVMAXREDADH2", "A_NVMAXREDADH3", "A_NVP12", "A_NVP23")},
    "Q_NVLOCACC": Variable(6),
    "M_NVAVADH": Variable(5),
    "M_NVEBCL": Variable(4),
    "Q_NVKVINTSET": Variable(2, frozenset({2, 3})),
    "M_NVKVINT": Variable(7),
    "L_NVKRINT": Variable(5),
    "M_NVKRINT": Variable(5),
    "M_NVKTINT": Variable(5),
}  # fmt: skip


def variable_of(name: str) -> Variable:
    """Return the variable of a name; a second value of one variable is named with an index, `M_NVKVINT(2)`."""
    return VARIABLES[name.partition("(")[0]]


def require(name: str, value: object) -> int:
    """Return the value; InputError where it is no whole number of that many bits, or spare."""
    variable = variable_of(name)
    if isinstance(value, bool) or not isinstance(value, int) or not 0 <= value < 2**variable.bits:
        raise InputError(f"{name} is {value!r}; give a whole number from 0 to {2**variable.bits - 1}.")
    if value in variable.spare:
        raise InputError(f"{name} is {value}, which is spare.")
    return value


def scale_mm(q_scale: int) -> int:
    """Return the mm of one unit of length for a Q_SCALE: 10 cm, 1 m or 10 m. InputError for the spare value."""
    return _SCALE_MM[require("Q_SCALE", q_scale)]


def length_mm(value: int, q_scale: int) -> int:
    """Return a length in mm."""
    return value * scale_mm(q_scale)


def group_identity(nid_c: int, nid_bg: int) -> int:
    """Return NID_LRBG of a group: its country and its number in one."""
    return require("NID_C", nid_c) << _GROUP_BITS | require("NID_BG", nid_bg)
