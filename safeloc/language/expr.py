"""The language of machines: functions that declare variables and build terms.

Terms are of two families, `Num` and `Bool`, over whole numbers, enumerations and booleans (safeloc.language.nodes). Their
operators are `+ - * < <= > >= & | ~`, `eq`, `ne`, `one_of`, `implies`, `iff`; everything else is a function of this module.
"""

from __future__ import annotations

from dataclasses import dataclass
from fractions import Fraction
from typing import overload

from safeloc.errors import ModelError, UnitError, declared_at
from safeloc.language.nodes import (
    FALSE,
    INT64_MAX,
    INT64_MIN,
    TRUE,
    Add,
    Bool,
    BoolVar,
    Choose,
    ChooseBool,
    Expr,
    FloorDiv,
    Lit,
    Max,
    Min,
    Num,
    NumVar,
    Truth,
    Var,
    all_of,
    any_of,
    arith,
    as_bool,
    as_num,
    need_same_unit,
    product,
)
from safeloc.language.units import ONE, Enumeration, Unit

__all__ = [
    "FALSE",
    "TRUE",
    "Bool",
    "BoolVar",
    "Expr",
    "Lit",
    "Num",
    "NumVar",
    "Optional",
    "Var",
    "abs_",
    "all_of",
    "any_of",
    "as_bool",
    "as_num",
    "before",
    "between",
    "boolean",
    "ceil_div",
    "ceil_to",
    "choice",
    "enumeration",
    "exact_to",
    "floor_div",
    "floor_to",
    "ite",
    "maximum",
    "members",
    "minimum",
    "number",
    "optional",
    "product",
    "was",
    "with_unit",
]


# ------------------------------------------------------------------ declaring


@dataclass(frozen=True, eq=False, slots=True)
class Optional:
    """An input that may be absent in a step: read `value` only under `present`."""

    value: NumVar
    present: BoolVar

    def value_or(self, default: Num | int) -> Num:
        """Return the term for the value, or `default` in steps in which the input is absent."""
        return ite(self.present, self.value, default)


def number(name: str, unit: Unit, low: int, high: int) -> NumVar:
    """Declare a whole-number variable in `unit` with an inclusive range; ModelError if the range is empty or beyond int64."""
    src = declared_at()
    if any(isinstance(bound, bool) or not isinstance(bound, int) for bound in (low, high)):
        raise ModelError(f"{src}: range of {name!r} is {low!r}..{high!r}; give its bounds as whole numbers.")
    if not INT64_MIN <= low <= high <= INT64_MAX:
        raise ModelError(
            f"{src}: range of {name!r} is {low}..{high}; it must be non-empty and fit 64 bits, low end first."
        )
    return NumVar(name, unit, low, high, None, src)


def boolean(name: str) -> BoolVar:
    """Declare a truth-valued variable."""
    return BoolVar(name, None, declared_at())


def choice(name: str, enumeration: Enumeration) -> NumVar:
    """Declare a variable that holds a member of `enumeration`."""
    return NumVar(name, enumeration, 0, len(enumeration.members) - 1, None, declared_at())


def optional(name: str, unit: Unit, low: int, high: int) -> Optional:
    """Declare a whole-number input that may be absent; its presence is the variable `name.present`."""
    return Optional(number(name, unit, low, high), BoolVar(f"{name}.present", None, declared_at()))


def members(name: str, *labels: str) -> tuple[Lit, ...]:
    """Create a new enumeration; return its members, in order, as constants. ModelError if two labels are equal."""
    if len(set(labels)) != len(labels):
        raise ModelError(f"{declared_at()}: {name} has labels {list(labels)}; they must be distinct.")
    enumeration = Enumeration(name, labels)
    return tuple(Lit(index, enumeration) for index in range(len(labels)))


def enumeration(constants: tuple[Lit, ...]) -> Enumeration:
    """Return the enumeration that constants made by `members` belong to."""
    unit = constants[0].unit
    if not isinstance(unit, Enumeration):
        raise UnitError(f"{declared_at()}: {constants[0].label} is a number, not a member of an enumeration.")
    return unit


def _named(var: object) -> str:
    return var.name if isinstance(var, (NumVar, BoolVar)) else "x"


def before(var: NumVar) -> NumVar:
    """Return, for use in a property, the value of a state variable before the step. UnitError for a truth value (`was`)."""
    if not isinstance(var, NumVar):
        raise UnitError(f"{declared_at()}: before(...) is for numbers; write was({_named(var)}) for a truth value.")
    return NumVar(f"before.{var.name}", var.unit, var.low, var.high, var, declared_at())


def was(var: BoolVar) -> BoolVar:
    """Return, for use in a property, the truth value of a state variable before the step. UnitError for a number (`before`)."""
    if not isinstance(var, BoolVar):
        raise UnitError(f"{declared_at()}: was(...) is for truth values; write before({_named(var)}) for a number.")
    return BoolVar(f"before.{var.name}", var, declared_at())


def before_step(var: Var) -> Var:
    """Return, for use in a property, the value of a state variable before the step: `before` or `was`, by its kind."""
    return before(var) if isinstance(var, NumVar) else was(var)


# ------------------------------------------------------------------ building


@overload
def ite(condition: Bool | bool, then: Bool | bool, other: Bool) -> Bool: ...


@overload
def ite(condition: Bool | bool, then: Bool, other: Bool | bool) -> Bool: ...


@overload
def ite(condition: Bool | bool, then: Num, other: Num | int) -> Num: ...


@overload
def ite(condition: Bool | bool, then: Num | int, other: Num) -> Num: ...


def ite(condition: Bool | bool, then: Expr | int | bool, other: Expr | int | bool) -> Expr:
    """Return the term that is `then` if the condition holds, else `other`; UnitError if their kinds or units differ."""
    condition = as_bool(condition)
    if isinstance(then, (Bool, bool)) and isinstance(other, (Bool, bool)):
        return _choose_bool(condition, as_bool(then), as_bool(other))
    if isinstance(then, (Bool, bool)) or isinstance(other, (Bool, bool)):
        raise UnitError(f"{declared_at()}: ite() mixes a number and a truth value.")
    unit = then.unit if isinstance(then, Num) else other.unit if isinstance(other, Num) else ONE
    then, other = as_num(then, unit), as_num(other, unit)
    need_same_unit("choose between", then, other)
    if isinstance(condition, Truth):
        return then if condition.value else other
    return Choose(condition, then, other, unit)


def _choose_bool(condition: Bool, then: Bool, other: Bool) -> Bool:
    if isinstance(condition, Truth):
        return then if condition.value else other
    if isinstance(then, Truth):
        return condition | other if then.value else ~condition & other
    if isinstance(other, Truth):
        return ~condition | then if other.value else condition & then
    return ChooseBool(condition, then, other)


def minimum(left: Num, right: Num | int) -> Num:
    """Return the term for the smaller of two numbers."""
    return arith(Min, left, right, min)


def maximum(left: Num, right: Num | int) -> Num:
    """Return the term for the greater of two numbers."""
    return arith(Max, left, right, max)


def abs_(term: Num) -> Num:
    """Return the term for the magnitude of a number."""
    return maximum(term, -term)


def between(low: Num | int, term: Num, high: Num | int) -> Bool:
    """Return the condition low <= term <= high."""
    return (as_num(low, term.unit) <= term) & (term <= high)


def floor_div(term: Num, divisor: int) -> Num:
    """Return term / divisor, rounded down (for a lower bound), in the term's unit. ModelError if the divisor is not positive."""
    if isinstance(term.unit, Enumeration):
        raise UnitError(f"{declared_at()}: arithmetic on an enumeration.")
    if isinstance(divisor, bool) or not isinstance(divisor, int) or divisor <= 0:
        raise ModelError(f"{declared_at()}: divisor {divisor!r} must be a positive whole-number constant.")
    if divisor == 1:
        return term
    return Lit(term.value // divisor, term.unit) if isinstance(term, Lit) else FloorDiv(term, divisor, term.unit)


def ceil_div(term: Num, divisor: int) -> Num:
    """Return term / divisor, rounded up (for an upper bound), in the term's unit. ModelError if the divisor is not positive."""
    return -floor_div(-term, divisor)


def floor_to(term: Num, unit: Unit) -> Num:
    """Return the term in another unit of the same dimension, rounded down if that unit is coarser."""
    factor = _factor(term, unit)
    return with_unit(floor_div(_times(term, factor.numerator), factor.denominator), unit)


def ceil_to(term: Num, unit: Unit) -> Num:
    """Return the term in another unit of the same dimension, rounded up if that unit is coarser."""
    factor = _factor(term, unit)
    return with_unit(ceil_div(_times(term, factor.numerator), factor.denominator), unit)


def exact_to(term: Num, unit: Unit) -> Num:
    """Return the term in a finer unit of the same dimension; ModelError if that would need rounding."""
    factor = _factor(term, unit)
    if factor.denominator != 1:
        raise ModelError(f"{declared_at()}: {unit.name} is no whole part of {term.unit.name}; use floor_to or ceil_to.")
    return with_unit(_times(term, factor.numerator), unit)


def with_unit(term: Num, unit: Unit) -> Num:
    """Return the same number with another unit: for conversions that a model defines itself, without a fixed scale."""
    match term:
        case Lit(value, _):
            return Lit(value, unit)
        case FloorDiv(left, divisor, _):
            return FloorDiv(left, divisor, unit)
        case _:
            return Add(term, Lit(0, unit), unit)


def _times(term: Num, factor: int) -> Num:
    return term if factor == 1 else term * factor


def _factor(term: Num, unit: Unit) -> Fraction:
    if isinstance(term.unit, Enumeration) or term.unit.dimension != unit.dimension:
        raise UnitError(f"{declared_at()}: cannot convert {term.unit.name} to {unit.name}.")
    return term.unit.scale / unit.scale
