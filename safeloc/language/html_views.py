"""Machines, runs and verdicts as HTML, which a notebook shows in place of their `repr`."""

from __future__ import annotations

from collections.abc import Iterable, Mapping, Sequence
from html import escape
from typing import TYPE_CHECKING

from safeloc.language.nodes import Value
from safeloc.language.trace import Trace, present_inputs, shown
from safeloc.language.transition_rows import transition_rows

if TYPE_CHECKING:
    from safeloc.language.machine import Machine

_MOST_STEPS = 60


def machine_html(machine: Machine) -> str:
    """Return name, summary and transition table of a machine."""
    heads = ("transition", "from", "to", "guard", "sets", "requirements")
    rows = (
        (row.name, row.source, row.target, row.guard, "; ".join(row.sets), ", ".join(row.requirements))
        for row in transition_rows(machine)
    )
    summary = machine.doc.partition("\n\n")[0]
    about = f"<p>{escape(summary)}</p>" if summary else ""
    modes = ", ".join(mode.label for mode in machine.modes)
    return (
        f"<p><b>{escape(machine.name)}</b>: machine with the modes {escape(modes)}</p>{about}{html_table(heads, rows)}"
    )


def trace_html(trace: Trace) -> str:
    """Return the run as a table: in each step what fires, the inputs that came and those just gone, and the state that changes.

    Of a run longer than 60 steps, those steps are shown that a text table shows.
    """
    kept = trace.shown_steps(_MOST_STEPS)
    rows = [("0", "start", "", _values(trace, trace.initial)), *(_step(trace, number) for number in kept)]
    left_out = len(trace.steps) - len(kept)
    more = f"<p>{left_out} more steps are left out.</p>" if left_out else ""
    return html_table(("step", "fires", "inputs", "state that changes"), rows) + more


def verdict_html(word: str, text: str, trace: Trace | None) -> str:
    """Return a verdict: its word, engine or reason, and the run that is its evidence."""
    return (
        f"<p><b>{escape(word)}</b>{f': {escape(text)}' if text else ''}</p>{'' if trace is None else trace_html(trace)}"
    )


def _step(trace: Trace, number: int) -> tuple[str, str, str, str]:
    step = trace.steps[number - 1]
    before = trace.steps[number - 2].state if number > 1 else trace.initial
    changed = {name: value for name, value in step.state.items() if before[name] != value}
    came = present_inputs(trace.system, step.inputs)
    earlier = present_inputs(trace.system, trace.steps[number - 2].inputs) if number > 1 else {}
    inputs = "  ".join(filter(None, (_values(trace, came), *(f"no {name}" for name in earlier if name not in came))))
    return str(number), ", ".join(step.fired.values()), inputs, _values(trace, changed)


def _values(trace: Trace, values: Mapping[str, Value]) -> str:
    return "  ".join(f"{name}={shown(trace.system.variable(name), value)}" for name, value in values.items())


def html_table(heads: Sequence[str], rows: Iterable[Sequence[str]]) -> str:
    """Return a table; every cell is text, and what looks like markup in it stays text."""
    top = "".join(f"<th>{escape(head)}</th>" for head in heads)
    body = "".join(f"<tr>{''.join(f'<td>{escape(cell)}</td>' for cell in row)}</tr>" for row in rows)
    return f"<table><thead><tr>{top}</tr></thead><tbody>{body}</tbody></table>"
