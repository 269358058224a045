"""safeloc: safety verification for train localization. State machines declared once; see the package's README.

The names here are public and stay; everything else may change between versions. Nothing heavy is imported.
"""

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
    UnforeseenError,
    UnitError,
    UnknownNameError,
)
from safeloc.language.absence import shown_if
from safeloc.language.composition import Clause, compose
from safeloc.language.declared import Declared
from safeloc.language.expr import (
    abs_,
    before,
    between,
    boolean,
    ceil_div,
    ceil_to,
    choice,
    enumeration,
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
    with_unit,
)
from safeloc.language.interpret import run
from safeloc.language.machine import ANY, Machine, Transition, current_mode, modes
from safeloc.language.spec import always, never, once, previous, reachable, since, within
from safeloc.language.system import lower, without_ghosts
from safeloc.language.verdict import Held, Proved, Unknown, Violated, require_proved
from safeloc.language.world import Law, World
from safeloc.moved import refuse_old_names as _refuse_old_names
from safeloc.simulated import SimulatedRun

__all__ = [
    "ANY",
    "Clause",
    "Declared",
    "EngineError",
    "Held",
    "InputError",
    "Law",
    "Machine",
    "ModelError",
    "NotProvedError",
    "PropertyError",
    "Proved",
    "SafelocError",
    "SimulatedRun",
    "SnapshotError",
    "StreamError",
    "Transition",
    "TruthValueError",
    "UnforeseenError",
    "UnitError",
    "Unknown",
    "UnknownNameError",
    "Violated",
    "World",
    "abs_",
    "always",
    "before",
    "between",
    "boolean",
    "ceil_div",
    "ceil_to",
    "choice",
    "compose",
    "current_mode",
    "enumeration",
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
    "shown_if",
    "since",
    "was",
    "with_unit",
    "within",
    "without_ghosts",
]

_refuse_old_names()
