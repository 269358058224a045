"""A second opinion: the SMT-LIB2 text of every proof is decided once more, by cvc5, from the text alone."""

from __future__ import annotations

import cvc5

from safeloc.errors import EngineError

ENGINE = f"cvc5 {cvc5.__version__}"


def recheck(name: str, text: str, *, seconds: float = 60.0) -> int:
    """Decide every query in the text; EngineError unless each answer is `unsat`. Returns how many there were."""
    answers = decide(name, text, seconds=seconds)
    wrong = [number for number, answer in enumerate(answers, 1) if answer != "unsat"]
    if wrong or not answers:
        raise EngineError(
            f"{name}: cvc5 does not confirm the proof: answers {answers or 'none'}, expected unsat everywhere. Do not use "
            "this result; keep the text and report it."
        )
    return len(answers)


def decide(name: str, text: str, *, seconds: float) -> list[str]:
    """cvc5's answers to the text's `check-sat` commands, in order."""
    terms = cvc5.TermManager()
    solver, symbols = cvc5.Solver(terms), cvc5.SymbolManager(terms)
    solver.setOption("incremental", "true")
    solver.setOption("tlimit-per", str(max(1, int(seconds * 1000))))
    parser = cvc5.InputParser(solver, symbols)
    parser.setStringInput(cvc5.InputLanguage.SMT_LIB_2_6, text, name)
    answers = []
    while not (command := parser.nextCommand()).isNull():
        answer = str(command.invoke(solver, symbols)).strip()
        if answer and answer != "success":
            answers.append(answer)
    return answers
