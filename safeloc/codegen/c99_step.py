"""The step in generated C: of each machine the moves, as a function of its own, and the outputs over the state after.

Every value that a machine moves is read before any is written, so all its updates see the state before; what it hears of
earlier machines has been written by then.
"""

from __future__ import annotations

import re
from collections.abc import Iterator, Mapping, Sequence
from dataclasses import dataclass
from types import MappingProxyType

from safeloc.codegen.c99_layout import Field, Layout, remark
from safeloc.codegen.c99_names import distinct, identifier
from safeloc.codegen.c99_statements import given_names, line, statements
from safeloc.codegen.c99_terms import CTerms, constant
from safeloc.codegen.case_splitting import moves
from safeloc.codegen.dead_code import live
from safeloc.codegen.nested_statements import Block, Blocks, End, Test
from safeloc.codegen.simplify_under_facts import Known
from safeloc.codegen.stages import Stage, at_once, stages
from safeloc.language.nodes import Var

LONGEST = 3  # cases: compilers have most of the work with long functions, and so have readers
_WORD = re.compile(r"[A-Za-z_]\w*")


def advance(layout: Layout) -> str:
    """The moves, machine by machine; of a machine by itself in one function."""
    found = stages(layout.system)
    if len(found) == 1 or any(stage.before for stage in found):
        about = "/* The step itself: the inputs are in their ranges. All values are read before any is written. */\n"
        return about + _moving(layout, "advance", at_once(layout.system))
    names = _functions(found)
    about = "/* The moves of {}. All values that it moves are read before any is written. */\n"
    parts = [
        about.format(remark(stage.name)) + _moving(layout, name, stage)
        for name, stage in zip(names, found, strict=True)
    ]
    calls = "".join(f"    {name}(state, inputs, outputs);\n" for name in names)
    about = "/* The step itself, machine by machine: the inputs are in their ranges. */\n"
    return "\n".join([*parts, f"{about}{_head(layout, 'advance')}{calls}}}\n"])


def _functions(found: Sequence[Stage]) -> list[str]:
    taken: set[str] = set()
    return [distinct(f"advance_{identifier(stage.name)}", taken) for stage in found]


def _head(layout: Layout, name: str) -> str:
    p = layout.names.prefix
    return f"static inline void {name}({p}_state *state, const {p}_inputs *inputs, {p}_outputs *outputs)\n{{\n"


def _moving(layout: Layout, name: str, stage: Stage) -> str:
    """A function that moves what the stage moves."""
    system, known = layout.system, Known({})
    state, fired = (
        dict(zip(system.state, layout.state, strict=True)),
        dict(zip(system.fired, layout.fired, strict=True)),
    )
    slots = [
        *(_Slot(f"state->{state[var].name}", state[var], state[var].name) for var in stage.moved),
        *_told([fired[var] for var in stage.fired]),
    ]
    terms = [*stage.moved.values(), *stage.fired.values()]
    targets = [(f"next_{slot.field.name}", known(term)) for slot, term in zip(slots, terms, strict=True)]
    body = _writing(live(moves(layout.system, targets, blocks(layout, stage.after), LONGEST)), slots)
    return (
        f"{_head(layout, name)}{locals_of(body, layout.state, 'state')}"
        f"{locals_of(body, layout.inputs, 'inputs')}{_unused(body)}{body}}}\n"
    )


def _unused(body: str) -> str:
    return "" if "outputs->" in body else "    (void)outputs;\n"


def blocks(layout: Layout, after: Mapping[Var, Var] = MappingProxyType({})) -> Blocks:
    """What writes statements over the fields; what earlier machines have moved stands in the same ones."""
    names = layout.names.variables
    moved = {later: names[var] for later, var in after.items()}
    return Blocks(CTerms({**names, **moved}, layout.names.members))


@dataclass(frozen=True)
class _Slot:
    """A field that a value is written to; `kept` is the value with which it stays as it is."""

    place: str
    field: Field
    kept: str = ""

    def written(self, value: str) -> list[str]:
        """The assignment, if there is anything to assign."""
        return [] if value == self.kept else [f"{self.place} = {stored(self.field, value)};"]


def _writing(block: Block, slots: Sequence[_Slot]) -> str:
    """The statements, with what they end with written to the slots; once, before branches part, where they all agree."""
    ends = list(_ends(block))
    parting = next((n for n, statement in enumerate(block) if isinstance(statement, Test)), len(block))
    later = set(given_names(block[parting:]))
    alike = [
        len(ends) > 1 and len({end[n] for end in ends}) == 1 and later.isdisjoint(_WORD.findall(ends[0][n]))
        for n in range(len(slots))
    ]

    def assigned(values: Sequence[str], once: bool) -> list[str]:
        chosen = zip(slots, values, alike, strict=True)
        return [text for slot, value, same in chosen if same is once for text in slot.written(value)]

    def leaf(values: Sequence[str]) -> list[str]:
        return [*assigned(values, once=False), "return;"]

    before = "".join(line(text, 1) for text in assigned(ends[0], once=True))
    return statements(block[:parting], leaf) + before + statements(block[parting:], leaf)


def _ends(block: Block) -> Iterator[tuple[str, ...]]:
    """What every branch ends with."""
    for statement in block:
        if isinstance(statement, Test):
            yield from _ends(statement.block)
        elif isinstance(statement, End):
            yield statement.values


def stored(field: Field, value: str) -> str:
    """A value as the field holds it; members of enumerations fit 32 bits."""
    plain = re.fullmatch(r"[A-Z][A-Z0-9_]*", value)
    return f"(int32_t)({value})" if field.kind == "int32_t" and not plain else value


def _told(fields: Sequence[Field]) -> list[_Slot]:
    return [_Slot(f"outputs->{field.name}", field) for field in fields]


def locals_of(body: str, fields: Sequence[Field], pointer: str) -> str:
    """Locals for the fields that the body reads."""
    used = set(re.findall(r"(?<![>\w])[A-Za-z_]\w*", body))  # not the fields behind ->
    read = [field for field in fields if field.name in used]
    unused = "" if read or f"{pointer}->" in body else f"    (void){pointer};\n"
    return unused + "".join(f"    {_local(field, pointer)}\n" for field in read)


def _local(field: Field, pointer: str) -> str:
    value = f"{pointer}->{field.name}"
    if field.kind == "uint8_t":
        return f"const bool {field.name} = {value} != 0;"
    if field.present:
        return f"const int64_t {field.name} = {pointer}->{field.present} != 0 ? {value} : {constant(field.absent)};"
    return f"const int64_t {field.name} = {value};"


def show(layout: Layout) -> str:
    """The outputs over the state after the step."""
    p = layout.names.prefix
    targets = [(f"out_{field.name}", layout.shown[field.source]) for field in layout.outputs]
    body = _writing(live(blocks(layout).ending(targets)), _told(layout.outputs))
    unused = "" if layout.outputs else "    (void)outputs;\n"
    return (
        f"static inline void show(const {p}_state *state, {p}_outputs *outputs)\n{{\n{unused}"
        f"{locals_of(body, layout.state, 'state')}{body}}}\n"
    )
