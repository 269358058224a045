"""The nodes of the language: two families, `Num` and `Bool`, and a closed set of kinds.

Every back end is a `match` over these kinds that ends in `assert_never`. Nodes are immutable, compare by identity, and
have no truth value. The functions that build nodes check units, kinds and ranges; errors name the file and line of the
declaration.

    Num   Lit  NumVar  Add  Sub  Mul  FloorDiv  Min  Max  Choose
    Bool  Truth  BoolVar  Not  And  Or  ChooseBool  Compare  Past
"""

from __future__ import annotations

from collections.abc import Callable, Iterable
from dataclasses import dataclass, field
from typing import Literal, NoReturn, TypeAlias

from safeloc.errors import ModelError, TruthValueError, UnitError, declared_at
from safeloc.language.units import ONE, Enumeration, Unit

INT64_MIN, INT64_MAX = -(2**63), 2**63 - 1


class _Node:
    """Base of both families: refuses every use as a Python value."""

    __slots__ = ()

    def __bool__(self) -> NoReturn:
        raise TruthValueError(
            f"{declared_at()}: a symbolic term has no truth value. Use & | ~ for and, or, not; ite(c, a, b) for a "
            "choice; between(low, x, high) for a chained comparison; x.one_of(...) for `in`."
        )

    def __eq__(self, other: object) -> bool:
        if self is other:
            return True
        raise TruthValueError(f"{declared_at()}: == on a symbolic term. Use a.eq(b), a.ne(b) or x.one_of(...).")

    __hash__ = object.__hash__

    def __repr__(self) -> str:
        from safeloc.language.terms import text  # here, since `terms` imports this module

        return text(self)  # type: ignore[arg-type] # every node is a Num or a Bool

    def __format__(self, spec: str) -> NoReturn:
        raise TruthValueError(f"{declared_at()}: a symbolic term in an f-string has no value yet. Use repr(term).")

    def __iter__(self) -> NoReturn:
        raise TruthValueError(f"{declared_at()}: a symbolic term cannot be iterated.")

    def __contains__(self, item: object) -> NoReturn:
        raise TruthValueError(f"{declared_at()}: `in` on a symbolic term. Use x.one_of(...).")


class Num(_Node):
    """A whole-number term with a unit, or a member of an enumeration."""

    __slots__ = ()
    unit: Unit | Enumeration

    def __add__(self, other: Num | int) -> Num:
        return arith(Add, self, other, lambda a, b: a + b)

    def __radd__(self, other: int) -> Num:
        return as_num(other, self.unit) + self

    def __sub__(self, other: Num | int) -> Num:
        return arith(Sub, self, other, lambda a, b: a - b)

    def __rsub__(self, other: int) -> Num:
        return as_num(other, self.unit) - self

    def __neg__(self) -> Num:
        return as_num(0, self.unit) - self

    def __mul__(self, other: Num | int) -> Num:
        other = as_num(other, ONE)
        if not (isinstance(self, Lit) or isinstance(other, Lit)):
            raise ModelError(
                f"{declared_at()}: a product of two variables is not linear. Use product(a, b), which asks for bounded "
                "ranges, or multiply by a constant."
            )
        return product(self, other)

    def __rmul__(self, other: int) -> Num:
        return self * other

    def __floordiv__(self, other: object) -> NoReturn:
        raise ModelError(f"{declared_at()}: // hides the direction of rounding. Use floor_div(a, k) or ceil_div(a, k).")

    def __truediv__(self, other: object) -> NoReturn:
        raise ModelError(f"{declared_at()}: / is not exact on whole numbers. Use floor_div(a, k) or ceil_div(a, k).")

    def __and__(self, other: object) -> NoReturn:
        raise _no_truth_value(self)

    __rand__ = __or__ = __ror__ = __and__

    def __invert__(self) -> NoReturn:
        raise _no_truth_value(self)

    def __lt__(self, other: Num | int) -> Bool:
        return _compare("<", self, other)

    def __le__(self, other: Num | int) -> Bool:
        return _compare("<=", self, other)

    def __gt__(self, other: Num | int) -> Bool:
        return _compare("<", as_num(other, self.unit), self)

    def __ge__(self, other: Num | int) -> Bool:
        return _compare("<=", as_num(other, self.unit), self)

    def eq(self, other: Num | int) -> Bool:
        """Return the condition that both are equal."""
        return _compare("==", self, other)

    def ne(self, other: Num | int) -> Bool:
        """Return the condition that both differ."""
        return ~self.eq(other)

    def one_of(self, *others: Num | int) -> Bool:
        """Return the term that is true where this equals one of `others`."""
        return any_of(self.eq(other) for other in others)


class Bool(_Node):
    """A truth-valued term."""

    __slots__ = ()

    def __and__(self, other: Bool | bool) -> Bool:
        return all_of((self, as_bool(other)))

    def __rand__(self, other: bool) -> Bool:
        return all_of((as_bool(other), self))

    def __or__(self, other: Bool | bool) -> Bool:
        return any_of((self, as_bool(other)))

    def __ror__(self, other: bool) -> Bool:
        return any_of((as_bool(other), self))

    def __invert__(self) -> Bool:
        match self:
            case Truth(value):
                return Truth(not value)
            case Not(inner):
                return inner
            case _:
                return Not(self)

    def implies(self, other: Bool | bool) -> Bool:
        """Return the term that is false only where this holds and `other` does not."""
        return ~self | other

    def iff(self, other: Bool | bool) -> Bool:
        """Return the term that is true where both have the same truth value."""
        other = as_bool(other)
        return (self & other) | (~self & ~other)


@dataclass(frozen=True, eq=False, repr=False, slots=True)
class Lit(Num):
    """A constant."""

    value: int
    unit: Unit | Enumeration

    @property
    def label(self) -> str:
        """The member's label, or the number as text."""
        return self.unit.members[self.value] if isinstance(self.unit, Enumeration) else str(self.value)


@dataclass(frozen=True, eq=False, repr=False, slots=True)
class NumVar(Num):
    """A variable with an inclusive range.

    before  in a property: the state variable whose value before the step this one stands for
    src     file and line of the declaration
    """

    name: str
    unit: Unit | Enumeration
    low: int
    high: int
    before: NumVar | None = None
    src: str = field(default="", compare=False)


@dataclass(frozen=True, eq=False, repr=False, slots=True)
class Add(Num):
    """left + right."""

    left: Num
    right: Num
    unit: Unit | Enumeration


@dataclass(frozen=True, eq=False, repr=False, slots=True)
class Sub(Num):
    """left - right."""

    left: Num
    right: Num
    unit: Unit | Enumeration


@dataclass(frozen=True, eq=False, repr=False, slots=True)
class Mul(Num):
    """left * right."""

    left: Num
    right: Num
    unit: Unit | Enumeration

    @property
    def by_constant(self) -> bool:
        """True if one of the factors is a constant, so that the product is linear."""
        return isinstance(self.left, Lit) or isinstance(self.right, Lit)


@dataclass(frozen=True, eq=False, repr=False, slots=True)
class FloorDiv(Num):
    """left / divisor, rounded towards minus infinity; the divisor is a positive constant."""

    left: Num
    divisor: int
    unit: Unit | Enumeration


@dataclass(frozen=True, eq=False, repr=False, slots=True)
class Min(Num):
    """The smaller of two numbers."""

    left: Num
    right: Num
    unit: Unit | Enumeration


@dataclass(frozen=True, eq=False, repr=False, slots=True)
class Max(Num):
    """The greater of two numbers."""

    left: Num
    right: Num
    unit: Unit | Enumeration


@dataclass(frozen=True, eq=False, repr=False, slots=True)
class Choose(Num):
    """The number `then` if the condition holds, else `other`."""

    condition: Bool
    then: Num
    other: Num
    unit: Unit | Enumeration


@dataclass(frozen=True, eq=False, repr=False, slots=True)
class Truth(Bool):
    """A constant truth value."""

    value: bool


@dataclass(frozen=True, eq=False, repr=False, slots=True)
class BoolVar(Bool):
    """A truth-valued variable; `before` as in NumVar."""

    name: str
    before: BoolVar | None = None
    src: str = field(default="", compare=False)


@dataclass(frozen=True, eq=False, repr=False, slots=True)
class Not(Bool):
    """Negation."""

    inner: Bool


@dataclass(frozen=True, eq=False, repr=False, slots=True)
class And(Bool):
    """Conjunction: all parts hold."""

    parts: tuple[Bool, ...]


@dataclass(frozen=True, eq=False, repr=False, slots=True)
class Or(Bool):
    """Disjunction: at least one part holds."""

    parts: tuple[Bool, ...]


@dataclass(frozen=True, eq=False, repr=False, slots=True)
class ChooseBool(Bool):
    """The truth value `then` if the condition holds, else `other`."""

    condition: Bool
    then: Bool
    other: Bool


@dataclass(frozen=True, eq=False, repr=False, slots=True)
class Compare(Bool):
    """A comparison: left < right, left <= right or left == right."""

    op: Literal["<", "<=", "=="]
    left: Num
    right: Num


@dataclass(frozen=True, eq=False, repr=False, slots=True)
class Past(Bool):
    """A pure-past operator, allowed in properties only (`spec.observe` turns it into a state variable)."""

    op: Literal["previous", "once", "since"]
    parts: tuple[Bool, ...]


NumNode: TypeAlias = Lit | NumVar | Add | Sub | Mul | FloorDiv | Min | Max | Choose
BoolNode: TypeAlias = Truth | BoolVar | Not | And | Or | ChooseBool | Compare | Past
Node: TypeAlias = NumNode | BoolNode
Expr: TypeAlias = Num | Bool
Var: TypeAlias = NumVar | BoolVar
Value: TypeAlias = int | bool

TRUE, FALSE = Truth(True), Truth(False)


# ------------------------------------------------------------------ functions behind the operators


def as_num(value: Num | int, unit: Unit | Enumeration) -> Num:
    """Return a term as it is; a bare int becomes a constant in `unit`."""
    if isinstance(value, Num):
        return value
    if isinstance(value, bool) or not isinstance(value, int):
        hint = (
            " Give a mode or a member itself, as modes(...) or members(...) made it." if isinstance(value, str) else ""
        )
        raise UnitError(
            f"{declared_at()}: expected a whole number or a Num term, got {type(value).__name__} {value!r}.{hint}"
        )
    if isinstance(unit, Enumeration) and not 0 <= value < len(unit.members):
        raise UnitError(f"{declared_at()}: {value} is no member of enumeration {unit.name}: {', '.join(unit.members)}.")
    return Lit(value, unit)


def as_bool(value: Bool | bool) -> Bool:
    """Return a term as it is; a bare bool becomes a constant."""
    if isinstance(value, Bool):
        return value
    if not isinstance(value, bool):
        raise _no_truth_value(value)
    return TRUE if value else FALSE


def _no_truth_value(value: object) -> UnitError:
    bracket = (
        " & and | bind tighter than comparisons: put the comparison in brackets, a & (b <= c)."
        if isinstance(value, Num)
        else ""
    )
    return UnitError(
        f"{declared_at()}: expected a truth value or a Bool term, got {type(value).__name__} {value!r}.{bracket}"
    )


def all_of(parts: Iterable[Bool | bool]) -> Bool:
    """Return the conjunction; true if there are no parts."""
    kept = [part for part in map(as_bool, parts) if not (isinstance(part, Truth) and part.value)]
    if any(isinstance(part, Truth) for part in kept):
        return FALSE
    return TRUE if not kept else kept[0] if len(kept) == 1 else And(tuple(kept))


def any_of(parts: Iterable[Bool | bool]) -> Bool:
    """Return the disjunction; false if there are no parts."""
    kept = [part for part in map(as_bool, parts) if not (isinstance(part, Truth) and not part.value)]
    if any(isinstance(part, Truth) for part in kept):
        return TRUE
    return FALSE if not kept else kept[0] if len(kept) == 1 else Or(tuple(kept))


def product(left: Num, right: Num) -> Num:
    """Return left * right, also for two variables: their ranges must limit it to 64 bits (an obligation proves it)."""
    if isinstance(left.unit, Enumeration) or isinstance(right.unit, Enumeration):
        raise UnitError(f"{declared_at()}: arithmetic on an enumeration.")
    if isinstance(left, Lit) and isinstance(right, Lit):
        return Lit(left.value * right.value, left.unit.times(right.unit))
    return Mul(left, right, left.unit.times(right.unit))


def arith(kind: type[Add | Sub | Min | Max], left: Num, right: Num | int, fold: Callable[[int, int], int]) -> Num:
    """Return the operation on two numbers, computed by `fold` if both are constants; UnitError if their units differ."""
    right = as_num(right, left.unit)
    need_same_unit(kind.__name__.lower(), left, right)
    if isinstance(left.unit, Enumeration):
        raise UnitError(f"{declared_at()}: arithmetic on enumeration {left.unit.name}.")
    if isinstance(left, Lit) and isinstance(right, Lit):
        return Lit(fold(left.value, right.value), left.unit)
    if kind in (Add, Sub) and isinstance(right, Lit) and right.value == 0:
        return left
    if kind is Add and isinstance(left, Lit) and left.value == 0:
        return right
    return kind(left, right, left.unit)


def _compare(op: Literal["<", "<=", "=="], left: Num, right: Num | int) -> Bool:
    right = as_num(right, left.unit)
    need_same_unit("compare", left, right)
    if op != "==" and isinstance(left.unit, Enumeration):
        raise UnitError(f"{declared_at()}: enumeration {left.unit.name} has no order; use eq, ne or one_of.")
    if isinstance(left, Lit) and isinstance(right, Lit):
        a, b = left.value, right.value
        return Truth(a < b if op == "<" else a <= b if op == "<=" else a == b)
    return Compare(op, left, right)


def need_same_unit(what: str, left: Num, right: Num) -> None:
    """Raise UnitError if the units differ; `what` is the verb of the message, such as "compare"."""
    if not left.unit.same(right.unit):
        raise UnitError(
            f"{declared_at()}: cannot {what} {left.unit.name} and {right.unit.name}. {_remedy(left, right)}"
        )


def _remedy(left: Num, right: Num) -> str:
    """Return how two units come together: by conversion if they are of one kind, else by a rule of the model."""
    first, second = left.unit, right.unit
    if not (isinstance(first, Unit) and isinstance(second, Unit)):
        return "A member of an enumeration is compared with members of the same one only."
    if first.dimension == second.dimension:
        return "Convert one with floor_to, ceil_to or exact_to."
    return (
        "They are of different kinds; with_unit(term, unit) says that a number of one kind stands for one of the other."
    )
