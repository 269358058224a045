"""The step in generated C: a function for the moves of each machine, and one for the outputs over the state after the step.

A machine's function reads all values before it writes any, so all its updates use the state before the step. The values that
it reads from earlier machines are written by then.
"""

from __future__ import annotations

from collections.abc import Iterator, Mapping, Sequence
from dataclasses import dataclass
from types import MappingProxyType

from safeloc.codegen.c99_layout import Field, Layout, remark
from safeloc.codegen.c99_names import distinct, identifier
from safeloc.codegen.c99_statements import Leaf, given_names, line, statements, used
from safeloc.codegen.c99_terms import CTerms, constant
from safeloc.codegen.case_splitting import moves
from safeloc.codegen.dead_code import live
from safeloc.codegen.naming_terms import Text
from safeloc.codegen.nested_statements import Block, Blocks, End, Test
from safeloc.codegen.simplify_under_facts import Known
from safeloc.codegen.stages import Stage, at_once, stages
from safeloc.language.nodes import Var

_LONGEST = 3  # all cases together may have three times the work: long functions slow down compilers and readers


def advance(layout: Layout) -> Text:
    """Return the code of all moves: a function for each machine of a composition, and one that calls them."""
    found = stages(layout.system)
    if len(found) == 1 or any(stage.before for stage in found):
        about = "/* The step itself: the inputs are in their ranges. All values are read before any is written. */\n"
        return _moving(layout, "advance", at_once(layout.system)).within(about)
    names = _functions(found)
    about = "/* The moves of {}. All values that it moves are read before any is written. */\n"
    parts = [
        _moving(layout, name, stage).within(about.format(remark(stage.name)))
        for name, stage in zip(names, found, strict=True)
    ]
    calls = "".join(f"    {name}(state, inputs, outputs);\n" for name in names)
    about = "/* The step itself, machine by machine: the inputs are in their ranges. */\n"
    return joined([*parts, Text(f"{about}{_head(layout, 'advance')}{calls}}}\n")], "\n")


def joined(parts: Sequence[Text], between: str = "") -> Text:
    """Return the parts as one text, with `between` in between."""
    return Text(between.join(part.code for part in parts), frozenset[str]().union(*(part.uses for part in parts)))


def _functions(found: Sequence[Stage]) -> list[str]:
    taken: set[str] = set()
    return [distinct(f"advance_{identifier(stage.name)}", taken) for stage in found]


def _head(layout: Layout, name: str) -> str:
    p = layout.names.prefix
    return f"static inline void {name}({p}_state *state, const {p}_inputs *inputs, {p}_outputs *outputs)\n{{\n"


def _moving(layout: Layout, name: str, stage: Stage) -> Text:
    """Return the function that moves the variables of a stage."""
    system, known = layout.system, Known({})
    state, fired = (
        dict(zip(system.state, layout.state, strict=True)),
        dict(zip(system.fired, layout.fired, strict=True)),
    )
    slots = [
        *(_Slot("state", state[var], state[var].name) for var in stage.moved),
        *_output_slots([fired[var] for var in stage.fired]),
    ]
    terms = [*stage.moved.values(), *stage.fired.values()]
    targets = [(f"next_{slot.field.name}", known(term)) for slot, term in zip(slots, terms, strict=True)]
    body = _writing(live(moves(layout.system, targets, blocks(layout, stage.after), _LONGEST)), slots)
    read = f"{locals_of(body, layout.state, 'state')}{locals_of(body, layout.inputs, 'inputs')}{_unused(body)}"
    return body.within(f"{_head(layout, name)}{read}", "}\n")


def _unused(body: Text) -> str:
    return "" if "outputs" in body.uses else "    (void)outputs;\n"


def blocks(layout: Layout, after: Mapping[Var, Var] = MappingProxyType({})) -> Blocks:
    """Return a writer of statements over the fields; values after earlier machines' moves are in the same fields."""
    names = layout.names.variables
    moved = {later: names[var] for later, var in after.items()}
    return Blocks(CTerms({**names, **moved}, layout.names.members))


@dataclass(frozen=True)
class _Slot:
    """A field to which a value is written; `kept` is the code of its present value, which needs no assignment."""

    pointer: str
    field: Field
    kept: str = ""

    def written(self, value: Text) -> list[Text]:
        """Return the assignment; none if the value stays the same."""
        if value.code == self.kept:
            return []
        text = _stored(self.field, value).within(f"{self.pointer}->{self.field.name} = ", ";")
        return [Text(text.code, text.uses | {self.pointer})]


def _writing(block: Block, slots: Sequence[_Slot]) -> Text:
    """Return the statements, with the final values written to the slots: before the branches if all agree, else in each."""
    ends = list(_ends(block))
    parting = next((n for n, statement in enumerate(block) if isinstance(statement, Test)), len(block))
    later = set(given_names(block[parting:]))
    alike = [
        len(ends) > 1 and len({end[n].code for end in ends}) == 1 and later.isdisjoint(ends[0][n].uses)
        for n in range(len(slots))
    ]

    def assigned(values: Sequence[Text], once: bool) -> list[Text]:
        chosen = zip(slots, values, alike, strict=True)
        return [text for slot, value, same in chosen if same is once for text in slot.written(value)]

    def leaf(values: Sequence[Text]) -> list[Text]:
        return [*assigned(values, once=False), Text("return;")]

    return joined(
        [
            body_of(block[:parting], leaf),
            *(Text(line(text.code, 1), text.uses) for text in assigned(ends[0], once=True)),
            body_of(block[parting:], leaf),
        ]
    )


def body_of(block: Block, leaf: Leaf) -> Text:
    """Return the statements of a block as text, with the names that they use."""
    return Text(statements(block, leaf), used(block, leaf))


def _ends(block: Block) -> Iterator[tuple[Text, ...]]:
    """Yield the final values of every branch."""
    for statement in block:
        if isinstance(statement, Test):
            yield from _ends(statement.block)
        elif isinstance(statement, End):
            yield statement.values


def _stored(field: Field, value: Text) -> Text:
    """Return a value converted to the type of the field; members of enumerations fit 32 bits."""
    return value.within("(int32_t)(", ")") if field.kind == "int32_t" and value.uses else value


def _output_slots(fields: Sequence[Field]) -> list[_Slot]:
    return [_Slot("outputs", field) for field in fields]


def locals_of(body: Text, fields: Sequence[Field], pointer: str) -> str:
    """Return the declarations of locals for the fields that the body reads."""
    read = [field for field in fields if field.name in body.uses]
    unused = "" if read or pointer in body.uses else f"    (void){pointer};\n"
    return unused + "".join(f"    {_local(field, pointer)}\n" for field in read)


def _local(field: Field, pointer: str) -> str:
    value = f"{pointer}->{field.name}"
    if field.kind == "uint8_t":
        return f"const bool {field.name} = {value} != 0;"
    if field.present:
        return f"const int64_t {field.name} = {pointer}->{field.present} != 0 ? {value} : {constant(field.absent)};"
    return f"const int64_t {field.name} = {value};"


def show(layout: Layout) -> Text:
    """Return the function that computes the outputs from the state after the step."""
    p = layout.names.prefix
    targets = [(f"out_{field.name}", layout.shown[field.source]) for field in layout.outputs]
    body = _writing(live(blocks(layout).ending(targets)), _output_slots(layout.outputs))
    unused = "" if layout.outputs else "    (void)outputs;\n"
    head = f"static inline void show(const {p}_state *state, {p}_outputs *outputs)\n{{\n{unused}"
    return body.within(f"{head}{locals_of(body, layout.state, 'state')}", "}\n")
