"""A system's moves, outputs and first state as JavaScript functions over arrays of values.

No cases are written apart (`case_splitting`): here the size of the text counts more than the time of a step. In all functions `s` is the state before the step, `i` the inputs, `o` the state after it, and `f` the numbers of the transitions
that fired. Values are in the order of the system: numbers and members of enumerations are BigInt, truth values are truth values.
"""

from __future__ import annotations

from collections.abc import Callable, Mapping, Sequence
from typing import assert_never

from safeloc.codegen.c99_statements import given_names
from safeloc.codegen.dead_code import live
from safeloc.codegen.javascript_terms import JavaScriptTerms
from safeloc.codegen.nested_statements import Bind, Block, Blocks, Choice, End, Test
from safeloc.codegen.simplify_under_facts import Known
from safeloc.codegen.stages import Stage, stages
from safeloc.language.nodes import Expr, Var
from safeloc.language.system import TransitionSystem

Leaf = Callable[[Sequence[str]], str]
"""A function from the targets' values to the text at the end of a branch."""


def state_names(system: TransitionSystem, array: str = "s") -> dict[Var, str]:
    """Return the place of each state variable in an array of the text."""
    return {var: f"{array}[{place}]" for place, var in enumerate(system.state)}


def input_names(system: TransitionSystem) -> dict[Var, str]:
    """Return the place of each input in the array `i` of the text."""
    return {var: f"i[{place}]" for place, var in enumerate(system.inputs)}


def moving(system: TransitionSystem, *, checked: bool) -> str:
    """Return the text of a list of functions (s, i, o, f), which together make the step: one for each machine, in order.

    Each writes the values that it moves into `o`, which begins as a copy of `s`, and into `f`, which begins with zeros.
    """
    return f"[{','.join(_stage(system, stage, checked=checked) for stage in stages(system))}]"


def shown(system: TransitionSystem, *, checked: bool) -> str:
    """Return the text of the function from the state after the step to the list of outputs."""
    folded = Known({})
    written = JavaScriptTerms(state_names(system, "o"), checked=checked)
    targets = [(f"n{place}", folded(term)) for place, term in enumerate(system.outputs.values())]
    block = live(Blocks(written).ending(targets))
    return f"o=>{_body(block, written, _returned)}"


def _returned(values: Sequence[str]) -> str:
    return f"return[{','.join(values)}]"


def _stage(system: TransitionSystem, stage: Stage, *, checked: bool) -> str:
    """Return the function that moves the variables of a stage."""
    before, after = state_names(system), state_names(system, "o")
    names = {
        **before,
        **input_names(system),
        **{later: after[var] for later, var in stage.after.items()},
        **{earlier: before[var] for earlier, var in stage.before.items()},
    }
    written = JavaScriptTerms(names, checked=checked)
    fired = {var: f"f[{place}]" for place, var in enumerate(system.fired)}
    slots = [*((after[var], before[var]) for var in stage.moved), *((fired[var], "0n") for var in stage.fired)]
    terms = [*stage.moved.values(), *stage.fired.values()]
    folded = Known({})
    block = live(Blocks(written).ending([(f"n{place}", folded(term)) for place, term in enumerate(terms)]))

    def leaf(values: Sequence[str]) -> str:
        moved = zip(slots, values, strict=True)
        return "".join(f"{slot}={value};" for (slot, kept), value in moved if value != kept) + "return"

    return f"(s,i,o,f)=>{_body(block, written, leaf)}"


def _body(block: Block, written: JavaScriptTerms, leaf: Leaf) -> str:
    names = [*dict.fromkeys(given_names(block)), *(f"p{number}" for number in range(1, written.passing + 1))]
    return f"{{{_declared(names)}{_statements(block, leaf)}}}"


def _declared(names: Sequence[str]) -> str:
    return f"let {','.join(names)};" if names else ""


def _statements(block: Block, leaf: Leaf) -> str:
    """Return the statements as text, without blanks or ends of lines, since only machines read it."""
    text = ""
    for statement in block:
        match statement:
            case Bind(name, value, _):
                text += f"{name}={value.code};"
            case Test(test, inner):
                text += f"if({test.code}){{{_statements(inner, leaf)}}}"
            case Choice(branches, otherwise):
                tests = (f"if({test.code}){{{_statements(inner, leaf)}}}" for test, inner in branches)
                text += f"{'else '.join(tests)}else{{{_statements(otherwise, leaf)}}}"
            case End(values):
                text += leaf([value.code for value in values])
            case _:
                assert_never(statement)
    return text


def values_of(terms: Sequence[Expr], names: Mapping[Var, str]) -> str:
    """Return statements that compute all terms, one after another, and return the list of their values."""
    written = JavaScriptTerms(names)
    lines, given = list[str](), list[str]()
    for number, term in enumerate(written.repeated(terms), 1):
        lines.append(f"t{number}={written.code(term)};")
        given.append(f"t{number}")
        written.named[term] = given[-1]
    values = ",".join(written.code(term) for term in terms)
    passing = [f"p{number}" for number in range(1, written.passing + 1)]
    return f"{{{_declared([*given, *passing])}{''.join(lines)}return[{values}]}}"
