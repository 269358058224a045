"""safeloc: safety verification for train localization. State machines declared once; see the package's README.

The names here are public and stay; everything else may change between versions. Nothing heavy is imported.
"""

from safeloc.composition import compose
from safeloc.errors import (
    EngineError,
    InputError,
    ModelError,
    NotProvedError,
    PropertyError,
    SafelocError,
    SnapshotError,
    StreamError,
    TruthValueError,
    UnitError,
)
from safeloc.expr import (
    abs_,
    before,
    between,
    boolean,
    ceil_div,
    ceil_to,
    choice,
    exact_to,
    floor_div,
    floor_to,
    ite,
    maximum,
    members,
    minimum,
    number,
    optional,
    product,
    was,
)
from safeloc.interpret import run
from safeloc.machine import ANY, Machine, Transition, modes
from safeloc.spec import always, never, once, previous, reachable, since, within
from safeloc.system import lower, without_ghosts
from safeloc.verdict import Held, Proved, Unknown, Violated, require_proved

__all__ = [
    "ANY",
    "EngineError",
    "Held",
    "InputError",
    "Machine",
    "ModelError",
    "NotProvedError",
    "PropertyError",
    "Proved",
    "SafelocError",
    "SnapshotError",
    "StreamError",
    "Transition",
    "TruthValueError",
    "UnitError",
    "Unknown",
    "Violated",
    "abs_",
    "always",
    "before",
    "between",
    "boolean",
    "ceil_div",
    "ceil_to",
    "choice",
    "compose",
    "exact_to",
    "floor_div",
    "floor_to",
    "ite",
    "lower",
    "maximum",
    "members",
    "minimum",
    "modes",
    "never",
    "number",
    "once",
    "optional",
    "previous",
    "product",
    "reachable",
    "require_proved",
    "run",
    "since",
    "was",
    "within",
    "without_ghosts",
]
