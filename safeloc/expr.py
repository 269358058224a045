"""Expressions over whole numbers, enumerations and booleans: the language machines are written in.

Two families, `Num` and `Bool`, and a closed set of nodes; every back end is a `match` over them that ends in
`assert_never`. Nodes are immutable, compare by identity, and have no truth value. Units, kinds and ranges are
checked when a node is born; errors name the file and line of the declaration.

    Num   Lit  NumVar  Add  Sub  Mul  FloorDiv  Min  Max  Choose
    Bool  Truth  BoolVar  Not  And  Or  ChooseBool  Compare  Past
"""

from __future__ import annotations

from collections.abc import Callable, Iterable, Mapping
from dataclasses import dataclass, field
from fractions import Fraction
from typing import Literal, NoReturn, TypeAlias, assert_never, overload

from safeloc.errors import ModelError, TruthValueError, UnitError, declared_at
from safeloc.units import ONE, Enumeration, Unit

INT64_MIN, INT64_MAX = -(2**63), 2**63 - 1


class _Node:
    """What both families refuse: being taken for a Python value."""

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

    def __hash__(self) -> int:
        return id(self)

    def __repr__(self) -> str:
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
        return _arith(Add, self, other, lambda a, b: a + b)

    def __radd__(self, other: int) -> Num:
        return as_num(other, self.unit) + self

    def __sub__(self, other: Num | int) -> Num:
        return _arith(Sub, self, other, lambda a, b: a - b)

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

    def __lt__(self, other: Num | int) -> Bool:
        return _compare("<", self, other)

    def __le__(self, other: Num | int) -> Bool:
        return _compare("<=", self, other)

    def __gt__(self, other: Num | int) -> Bool:
        return _compare("<", as_num(other, self.unit), self)

    def __ge__(self, other: Num | int) -> Bool:
        return _compare("<=", as_num(other, self.unit), self)

    def eq(self, other: Num | int) -> Bool:
        """Equality as a term."""
        return _compare("==", self, other)

    def ne(self, other: Num | int) -> Bool:
        """Inequality as a term."""
        return ~self.eq(other)

    def one_of(self, *others: Num | int) -> Bool:
        """Whether this equals one of `others`."""
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
        """False only where this holds and `other` does not."""
        return ~self | other

    def iff(self, other: Bool | bool) -> Bool:
        """Whether both have the same truth value."""
        other = as_bool(other)
        return (self & other) | (~self & ~other)


@dataclass(frozen=True, eq=False, repr=False, slots=True)
class Lit(Num):
    """A constant."""

    value: int
    unit: Unit | Enumeration

    @property
    def label(self) -> str:
        """The member's name, or the number as text."""
        return self.unit.members[self.value] if isinstance(self.unit, Enumeration) else str(self.value)


@dataclass(frozen=True, eq=False, repr=False, slots=True)
class NumVar(Num):
    """A variable with an inclusive range; `before` names the variable whose value before the step this is."""

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


@dataclass(frozen=True, eq=False, repr=False, slots=True)
class FloorDiv(Num):
    """left / divisor, rounded towards minus infinity; the divisor is a positive constant."""

    left: Num
    divisor: int
    unit: Unit | Enumeration


@dataclass(frozen=True, eq=False, repr=False, slots=True)
class Min(Num):
    """The smaller one."""

    left: Num
    right: Num
    unit: Unit | Enumeration


@dataclass(frozen=True, eq=False, repr=False, slots=True)
class Max(Num):
    """The greater one."""

    left: Num
    right: Num
    unit: Unit | Enumeration


@dataclass(frozen=True, eq=False, repr=False, slots=True)
class Choose(Num):
    """`then` where the condition holds, else `other`."""

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
    """All parts hold."""

    parts: tuple[Bool, ...]


@dataclass(frozen=True, eq=False, repr=False, slots=True)
class Or(Bool):
    """At least one part holds."""

    parts: tuple[Bool, ...]


@dataclass(frozen=True, eq=False, repr=False, slots=True)
class ChooseBool(Bool):
    """`then` where the condition holds, else `other`."""

    condition: Bool
    then: Bool
    other: Bool


@dataclass(frozen=True, eq=False, repr=False, slots=True)
class Compare(Bool):
    """left < right, left <= right or left == right."""

    op: Literal["<", "<=", "=="]
    left: Num
    right: Num


@dataclass(frozen=True, eq=False, repr=False, slots=True)
class Past(Bool):
    """A pure-past operator; properties only (`spec.observe` turns it into a state variable)."""

    op: Literal["previous", "once", "since"]
    parts: tuple[Bool, ...]


NumNode: TypeAlias = Lit | NumVar | Add | Sub | Mul | FloorDiv | Min | Max | Choose
BoolNode: TypeAlias = Truth | BoolVar | Not | And | Or | ChooseBool | Compare | Past
Node: TypeAlias = NumNode | BoolNode
Expr: TypeAlias = Num | Bool
Var: TypeAlias = NumVar | BoolVar
Value: TypeAlias = int | bool

TRUE, FALSE = Truth(True), Truth(False)


# ------------------------------------------------------------------ declaring


@dataclass(frozen=True, eq=False, slots=True)
class Optional:
    """An input that may be absent in a step: read `value` only under `present`."""

    value: NumVar
    present: BoolVar

    def value_or(self, default: Num | int) -> Num:
        """The value, or `default` when absent."""
        return ite(self.present, self.value, default)


def number(name: str, unit: Unit, low: int, high: int) -> NumVar:
    """A whole-number variable in `unit` with inclusive range; ModelError if the range is empty or beyond int64."""
    src = declared_at()
    if any(isinstance(bound, bool) or not isinstance(bound, int) for bound in (low, high)):
        raise ModelError(f"{src}: range of {name!r} is {low!r}..{high!r}; its bounds must be whole numbers.")
    if not INT64_MIN <= low <= high <= INT64_MAX:
        raise ModelError(f"{src}: range of {name!r} is {low}..{high}; it must be non-empty and fit 64 bits.")
    return NumVar(name, unit, low, high, None, src)


def boolean(name: str) -> BoolVar:
    """A truth-valued variable."""
    return BoolVar(name, None, declared_at())


def choice(name: str, enumeration: Enumeration) -> NumVar:
    """A variable that holds a member of `enumeration`."""
    return NumVar(name, enumeration, 0, len(enumeration.members) - 1, None, declared_at())


def optional(name: str, unit: Unit, low: int, high: int) -> Optional:
    """A whole-number input that may be absent; presence is the variable `name.present`."""
    return Optional(number(name, unit, low, high), BoolVar(f"{name}.present", None, declared_at()))


def members(name: str, *labels: str) -> tuple[Lit, ...]:
    """A new enumeration's members, in order, as constants; ModelError if two have one label."""
    if len(set(labels)) != len(labels):
        raise ModelError(f"{declared_at()}: {name} has labels {list(labels)}; they must be distinct.")
    enumeration = Enumeration(name, labels)
    return tuple(Lit(index, enumeration) for index in range(len(labels)))


def enumeration(constants: tuple[Lit, ...]) -> Enumeration:
    """The enumeration that constants made by `members` belong to."""
    unit = constants[0].unit
    if not isinstance(unit, Enumeration):
        raise UnitError(f"{declared_at()}: {constants[0].label} is a number, not a member of an enumeration.")
    return unit


def before(var: NumVar) -> NumVar:
    """In a property: the value of a state variable before the step."""
    return NumVar(f"before.{var.name}", var.unit, var.low, var.high, var, declared_at())


def was(var: BoolVar) -> BoolVar:
    """In a property: the truth value of a state variable before the step."""
    return BoolVar(f"before.{var.name}", var, declared_at())


# ------------------------------------------------------------------ building


def as_num(value: Num | int, unit: Unit | Enumeration) -> Num:
    """A term as it is; a bare int becomes a constant in `unit`."""
    if isinstance(value, Num):
        return value
    if isinstance(value, bool) or not isinstance(value, int):
        raise UnitError(
            f"{declared_at()}: expected a whole number or a Num term, got {type(value).__name__} {value!r}."
        )
    return Lit(value, unit)


def as_bool(value: Bool | bool) -> Bool:
    """A term as it is; a bare bool becomes a constant."""
    if isinstance(value, Bool):
        return value
    if not isinstance(value, bool):
        raise UnitError(
            f"{declared_at()}: expected a truth value or a Bool term, got {type(value).__name__} {value!r}."
        )
    return TRUE if value else FALSE


def all_of(parts: Iterable[Bool | bool]) -> Bool:
    """Conjunction; true when there are no parts."""
    kept = [part for part in map(as_bool, parts) if not (isinstance(part, Truth) and part.value)]
    if any(isinstance(part, Truth) for part in kept):
        return FALSE
    return TRUE if not kept else kept[0] if len(kept) == 1 else And(tuple(kept))


def any_of(parts: Iterable[Bool | bool]) -> Bool:
    """Disjunction; false when there are no parts."""
    kept = [part for part in map(as_bool, parts) if not (isinstance(part, Truth) and not part.value)]
    if any(isinstance(part, Truth) for part in kept):
        return TRUE
    return FALSE if not kept else kept[0] if len(kept) == 1 else Or(tuple(kept))


@overload
def ite(condition: Bool | bool, then: Bool | bool, other: Bool) -> Bool: ...
@overload
def ite(condition: Bool | bool, then: Bool, other: Bool | bool) -> Bool: ...
@overload
def ite(condition: Bool | bool, then: Num, other: Num | int) -> Num: ...
@overload
def ite(condition: Bool | bool, then: Num | int, other: Num) -> Num: ...
def ite(condition: Bool | bool, then: Expr | int | bool, other: Expr | int | bool) -> Expr:
    """`then` where the condition holds, else `other`; both of one kind and unit."""
    condition = as_bool(condition)
    if isinstance(then, (Bool, bool)) and isinstance(other, (Bool, bool)):
        return _choose_bool(condition, as_bool(then), as_bool(other))
    if isinstance(then, (Bool, bool)) or isinstance(other, (Bool, bool)):
        raise UnitError(f"{declared_at()}: ite() mixes a number and a truth value.")
    unit = then.unit if isinstance(then, Num) else other.unit if isinstance(other, Num) else ONE
    then, other = as_num(then, unit), as_num(other, unit)
    _need_same_unit("choose between", then, other)
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
    """The smaller one."""
    return _arith(Min, left, right, min)


def maximum(left: Num, right: Num | int) -> Num:
    """The greater one."""
    return _arith(Max, left, right, max)


def abs_(term: Num) -> Num:
    """The magnitude."""
    return maximum(term, -term)


def between(low: Num | int, term: Num, high: Num | int) -> Bool:
    """low <= term <= high."""
    return (as_num(low, term.unit) <= term) & (term <= high)


def product(left: Num, right: Num) -> Num:
    """left * right, also of two variables: their ranges must keep it within 64 bits (an obligation proves it)."""
    if isinstance(left.unit, Enumeration) or isinstance(right.unit, Enumeration):
        raise UnitError(f"{declared_at()}: arithmetic on an enumeration.")
    if isinstance(left, Lit) and isinstance(right, Lit):
        return Lit(left.value * right.value, left.unit.times(right.unit))
    return Mul(left, right, left.unit.times(right.unit))


def floor_div(term: Num, divisor: int) -> Num:
    """term / divisor rounded down: for a lower bound. The unit stays. ModelError if the divisor is not positive."""
    if isinstance(term.unit, Enumeration):
        raise UnitError(f"{declared_at()}: arithmetic on an enumeration.")
    if isinstance(divisor, bool) or not isinstance(divisor, int) or divisor <= 0:
        raise ModelError(f"{declared_at()}: divisor {divisor!r} must be a positive whole-number constant.")
    if divisor == 1:
        return term
    return Lit(term.value // divisor, term.unit) if isinstance(term, Lit) else FloorDiv(term, divisor, term.unit)


def ceil_div(term: Num, divisor: int) -> Num:
    """term / divisor rounded up: for an upper bound."""
    return -floor_div(-term, divisor)


def floor_to(term: Num, unit: Unit) -> Num:
    """The term in another unit of the same dimension, rounded down where it is coarser."""
    factor = _factor(term, unit)
    return with_unit(floor_div(_times(term, factor.numerator), factor.denominator), unit)


def ceil_to(term: Num, unit: Unit) -> Num:
    """The term in another unit of the same dimension, rounded up where it is coarser."""
    factor = _factor(term, unit)
    return with_unit(ceil_div(_times(term, factor.numerator), factor.denominator), unit)


def exact_to(term: Num, unit: Unit) -> Num:
    """The term in a finer unit of the same dimension; ModelError if that would need rounding."""
    factor = _factor(term, unit)
    if factor.denominator != 1:
        raise ModelError(f"{declared_at()}: {unit.name} is no whole part of {term.unit.name}; use floor_to or ceil_to.")
    return with_unit(_times(term, factor.numerator), unit)


def with_unit(term: Num, unit: Unit) -> Num:
    """The same number under another unit: for the model's own conversions, where no scale table can know better."""
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


def _arith(kind: type[Add | Sub | Min | Max], left: Num, right: Num | int, fold: Callable[[int, int], int]) -> Num:
    right = as_num(right, left.unit)
    _need_same_unit(kind.__name__.lower(), left, right)
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
    _need_same_unit("compare", left, right)
    if op != "==" and isinstance(left.unit, Enumeration):
        raise UnitError(f"{declared_at()}: enumeration {left.unit.name} has no order; use eq, ne or one_of.")
    if isinstance(left, Lit) and isinstance(right, Lit):
        a, b = left.value, right.value
        return Truth(a < b if op == "<" else a <= b if op == "<=" else a == b)
    return Compare(op, left, right)


def _need_same_unit(what: str, left: Num, right: Num) -> None:
    if not left.unit.same(right.unit):
        raise UnitError(
            f"{declared_at()}: cannot {what} {left.unit.name} and {right.unit.name}. Convert one with floor_to, ceil_to "
            "or exact_to."
        )


# ------------------------------------------------------------------ walking


def children(node: Expr) -> tuple[Expr, ...]:
    """The terms a node is made of."""
    assert isinstance(node, Node)
    match node:
        case Lit() | NumVar() | Truth() | BoolVar():
            return ()
        case Add(a, b) | Sub(a, b) | Mul(a, b) | Min(a, b) | Max(a, b):
            return (a, b)
        case FloorDiv(a, _):
            return (a,)
        case Choose(c, a, b, _):
            return (c, a, b)
        case ChooseBool(c, p, q):
            return (c, p, q)
        case Not(inner):
            return (inner,)
        case And(parts) | Or(parts) | Past(_, parts):
            return parts
        case Compare(_, a, b):
            return (a, b)
        case _:
            assert_never(node)


def in_order(roots: Iterable[Expr]) -> list[Node]:
    """Every node below `roots` once, parts before wholes; without recursion, so depth is no limit."""
    seen: set[int] = set()
    order: list[Node] = []
    stack: list[tuple[Expr, bool]] = [(root, False) for root in reversed(list(roots))]
    while stack:
        node, done = stack.pop()
        if done:
            assert isinstance(node, Node)
            order.append(node)
        elif id(node) not in seen:
            seen.add(id(node))
            stack.append((node, True))
            stack.extend((child, False) for child in reversed(children(node)) if id(child) not in seen)
    return order


def variables(roots: Iterable[Expr]) -> list[Var]:
    """The distinct variables below `roots`, in first-use order."""
    return [node for node in in_order(roots) if isinstance(node, Var)]


class Substitution:
    """Replaces variables by terms, keeping shared sub-terms shared across all the terms it is applied to."""

    def __init__(self, replacements: Mapping[Var, Expr]) -> None:
        self._done: dict[Expr, Expr] = {var: term for var, term in replacements.items()}

    def num(self, term: Num) -> Num:
        """The numeric term after replacement."""
        result = self(term)
        assert isinstance(result, Num)
        return result

    def bool(self, term: Bool) -> Bool:
        """The truth-valued term after replacement."""
        result = self(term)
        assert isinstance(result, Bool)
        return result

    def __call__(self, term: Expr) -> Expr:
        """The term after replacement."""
        if term not in self._done:
            for node in in_order([term]):
                if node not in self._done:
                    self._done[node] = rebuilt(node, tuple(self._done[child] for child in children(node)))
        return self._done[term]


class Sharing:
    """Makes equal sub-terms the same node, so that every back end computes each of them once."""

    def __init__(self) -> None:
        self._kept: dict[tuple[object, ...], Expr] = {}
        self._done: dict[Expr, Expr] = {}

    def __call__(self, term: Expr) -> Expr:
        """The term with equal parts shared, also with every term that was handed over before."""
        for node in in_order([term]):
            if node not in self._done:
                parts = tuple(self._done[child] for child in children(node))
                shared = rebuilt(node, parts)
                self._done[node] = self._kept.setdefault(_shape(shared), shared)
        return self._done[term]

    def num(self, term: Num) -> Num:
        """The same for a numeric term."""
        return _n(self(term))

    def bool(self, term: Bool) -> Bool:
        """The same for a truth-valued term."""
        return _b(self(term))


def _shape(term: Expr) -> tuple[object, ...]:
    """What tells two nodes apart, given that their parts are shared already."""
    assert isinstance(term, Node)
    parts = tuple(id(child) for child in children(term))
    match term:
        case NumVar() | BoolVar():
            return (id(term),)
        case Lit(value, unit):
            return (Lit, value, unit)
        case Truth(value):
            return (Truth, value)
        case FloorDiv(_, divisor, unit):
            return (FloorDiv, divisor, unit, parts)
        case Compare(op, _, _) | Past(op, _):
            return (type(term), op, parts)
        case Add() | Sub() | Mul() | Min() | Max() | Choose() | ChooseBool() | Not() | And() | Or():
            return (type(term), parts)
        case _:
            assert_never(term)


def rebuilt(node: Node, parts: tuple[Expr, ...]) -> Expr:
    """The node with other parts (of the same kinds); the node itself where they are the same."""
    if all(new is old for new, old in zip(parts, children(node), strict=True)):
        return node
    match node:
        case Add() | Sub() | Mul() | Min() | Max():
            return type(node)(_n(parts[0]), _n(parts[1]), node.unit)
        case FloorDiv(_, divisor, unit):
            return FloorDiv(_n(parts[0]), divisor, unit)
        case Choose():
            return Choose(_b(parts[0]), _n(parts[1]), _n(parts[2]), node.unit)
        case Not():
            return ~_b(parts[0])
        case And():
            return all_of(_b(part) for part in parts)
        case Or():
            return any_of(_b(part) for part in parts)
        case ChooseBool():
            return ChooseBool(_b(parts[0]), _b(parts[1]), _b(parts[2]))
        case Compare(op, _, _):
            return Compare(op, _n(parts[0]), _n(parts[1]))
        case Past(op, _):
            return Past(op, tuple(_b(part) for part in parts))
        case Lit() | NumVar() | Truth() | BoolVar():
            return node
        case _:
            assert_never(node)


def _n(term: Expr) -> Num:
    assert isinstance(term, Num)
    return term


def _b(term: Expr) -> Bool:
    assert isinstance(term, Bool)
    return term


def text(term: Expr, most: int = 200) -> str:
    """An S-expression of the term; after `most` nodes the rest is "...", since shared parts are written out each time."""
    return _Writer(most).write(term)


class _Writer:
    def __init__(self, most: int) -> None:
        self._left = most

    def write(self, term: Expr) -> str:
        self._left -= 1
        if self._left < 0:
            return "..."
        parts = children(term)
        return f"({_head(term)} {' '.join(self.write(part) for part in parts)}{_tail(term)})" if parts else _head(term)


def _head(term: Expr) -> str:
    assert isinstance(term, Node)
    match term:
        case Lit():
            return term.label
        case NumVar(name=name) | BoolVar(name=name):
            return name
        case Truth(value):
            return "true" if value else "false"
        case Compare(op, _, _) | Past(op, _):
            return op
        case Add() | Sub() | Mul() | FloorDiv() | Min() | Max() | Choose() | ChooseBool() | Not() | And() | Or():
            return _WORDS[type(term)]
        case _:
            assert_never(term)


def _tail(term: Expr) -> str:
    return f" {term.divisor}" if isinstance(term, FloorDiv) else ""


_WORDS: dict[type[Expr], str] = {
    Add: "+",
    Sub: "-",
    Mul: "*",
    FloorDiv: "floor_div",
    Min: "min",
    Max: "max",
    Choose: "ite",
    ChooseBool: "ite",
    Not: "not",
    And: "and",
    Or: "or",
}
