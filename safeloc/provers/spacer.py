"""Spacer (property-directed reachability): finds an inductive invariant by itself, without lemmas.

Its invariant is a z3 term; it is checked by three fresh z3 queries and, as text, by cvc5. The verdict carries that
text; the invariant is not translated back into our terms.
"""

from __future__ import annotations

import z3

from safeloc.backends.smt import Terms, constant
from safeloc.errors import EngineError
from safeloc.provers.limits import Limits
from safeloc.provers.recheck import ENGINE, recheck
from safeloc.spec import Goal
from safeloc.system import environment, in_range
from safeloc.verdict import Proved, Unknown, Verdict


def spacer(goal: Goal, limits: Limits) -> Verdict:
    """Proved or Unknown; a violation it claims is left to bounded search, which gives the trace."""
    system = goal.system
    now = Terms({var: constant(var) for var in (*system.state, *system.inputs)})
    later = Terms({var: constant(var, "'") for var in system.state})
    state, after = [now(var) for var in system.state], [later(var) for var in system.state]
    reached = z3.Function("reached", *(term.sort() for term in state), z3.BoolSort())
    engine = _engine(limits)
    engine.register_relation(reached)
    engine.declare_var(*state, *after, *(now(var) for var in system.inputs))
    first = z3.And(now.bool(system.init), now.bool(in_range(system.state)))
    moves = [later(var) == now(term) for var, term in system.next.items()]
    engine.rule(reached(*state), first)
    engine.rule(reached(*after), [reached(*state), now.bool(environment(system)), *moves])
    try:
        answer = engine.query(z3.And(reached(*state), z3.Not(now.bool(goal.good))))
    except z3.Z3Exception as error:
        return Unknown(f"spacer: {error}")
    if answer != z3.unsat:
        return Unknown(f"spacer: {'claims a violation' if answer == z3.sat else engine.reason_unknown()}")
    return _confirmed(goal, now, state, _body(engine.get_answer(), state))


def _engine(limits: Limits) -> z3.Fixedpoint:
    engine = z3.Fixedpoint()
    engine.set(engine="spacer", timeout=limits.milliseconds)
    engine.set("spacer.random_seed", limits.seed)
    return engine


def _body(answer: z3.ExprRef, state: list[z3.ExprRef]) -> z3.BoolRef:
    """The invariant over the state constants, out of `forall s. reached(s) = body(s)`."""
    if z3.is_quantifier(answer):
        equation = answer.body()
        body = equation.arg(1) if equation.num_args() == 2 else z3.BoolVal(True)
        order = [equation.arg(0).arg(index) for index in range(len(state))]
        slots = {z3.get_var_index(slot): constant_ for slot, constant_ in zip(order, state, strict=True)}
        return z3.substitute_vars(body, *(slots[index] for index in range(len(slots))))
    raise EngineError(f"spacer: its answer is no quantified equation: {answer.sexpr()[:200]}")


def _confirmed(goal: Goal, now: Terms, state: list[z3.ExprRef], invariant: z3.BoolRef) -> Verdict:
    """The invariant's three queries, by z3 and by cvc5; Unknown if it is not inductive after all."""
    system = goal.system
    after = [(now(var), now(system.next[var])) for var in system.state]
    moved = z3.substitute(invariant, *after)
    first = z3.And(now.bool(system.init), now.bool(in_range(system.state)))
    wanted = {
        "initially": [first, z3.Not(invariant)],
        "in every step": [invariant, now.bool(environment(system)), z3.Not(moved)],
        "implies the property": [invariant, z3.Not(now.bool(goal.good))],
    }
    texts = {}
    for name, assertions in wanted.items():
        solver = z3.Solver()
        solver.set("timeout", 60_000)
        solver.add(*assertions)
        if solver.check() != z3.unsat:
            return Unknown(f"spacer: its invariant fails the query {name!r}")
        file = f"{goal.original.name}-{goal.prop.name}-spacer-{name}.smt2".replace(" ", "-")
        texts[file] = f"(set-logic ALL)\n{_commands(solver.to_smt2())}"
        recheck(file, texts[file])
    return Proved(None, "spacer", 0, (ENGINE, "z3, fresh queries"), texts)


def _commands(text: str) -> str:
    return "\n".join(line for line in text.splitlines() if not line.startswith(("(set-", "; "))) + "\n"
