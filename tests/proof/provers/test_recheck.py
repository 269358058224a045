"""yices and cvc5 decide every certificate from its text, and a text that proves nothing is an error."""

from __future__ import annotations

import pickle
import re
from collections.abc import Callable

import cvc5
import pytest

from safeloc import yices
from safeloc.codegen.smtlib import Query, to_smtlib
from safeloc.errors import EngineError
from safeloc.language.expr import NumVar
from safeloc.language.units import ONE
from safeloc.language.verdict import Proved, require_proved
from safeloc.proof.provers import kinduction as prover
from safeloc.proof.provers import recheck as module
from safeloc.proof.provers.kinduction import kinduction
from safeloc.proof.provers.limits import Limits
from safeloc.proof.provers.recheck import (
    ConfirmedText,
    certify,
    confirmed_by,
    decide,
    file_name,
    recheck,
    rechecked_in_words,
)
from tests.proof.provers.small import FULL_TOGETHER, LEVEL, SAME, counter, goal, pair

needs_yices = pytest.mark.skipif(yices.program() is None, reason="yices is not installed")
CVC5 = f"cvc5 {cvc5.__version__}"
X = NumVar("x", ONE, 0, 9)
SOUND = Query("sound", [X > 3], {"above 2": X > 2, "above 0": X > 0})


def test_a_sound_query_is_confirmed() -> None:
    """Each goal is decided, and none is left over."""
    certificate = certify(SOUND, seconds=10.0, relies_on=["other.smt2"])
    assert certificate.undecided == ()
    assert certificate.file == file_name("sound", certificate.text)
    assert certificate.text.startswith("; safeloc-certificate/1\n; name: sound\n; relies on: other.smt2\n")
    assert decide("sound", certificate.text, seconds=10.0) == ["unsat", "unsat"]


@pytest.mark.parametrize("solver", [pytest.param("yices", marks=needs_yices), "cvc5"])
def test_a_goal_that_does_not_follow_is_an_error(solver: str, monkeypatch: pytest.MonkeyPatch) -> None:
    """If the second solver contradicts z3, everything stops with an error."""
    if solver == "cvc5":
        monkeypatch.setattr(yices, "program", lambda: None)
    wrong = Query("wrong", [X > 3], {"above 2": X > 2, "above 4": X > 4})
    with pytest.raises(
        EngineError,
        match=rf"wrong-[0-9a-f]{{16}}\.smt2: {solver} does not confirm the proof: answers \['unsat', 'sat'\]",
    ):
        certify(wrong, seconds=10.0)


def _proof() -> Proved:
    return require_proved(kinduction(goal(pair({"in step": SAME}), FULL_TOGETHER), Limits()))


CORRUPTED: dict[str, Callable[[str], str]] = {
    "hypotheses gone": lambda text: re.sub(r"^\(assert t.*\n", "", text, flags=re.MULTILINE),
    "a question left out": lambda text: text.replace("(check-sat)\n", "", 1),
    "a goal not negated": lambda text: text.replace("(assert (not ", "(assert (= true "),
    "a symbol gone": lambda text: text.replace("(declare-const |left| Int)", ""),
    "cut off": lambda text: text[: len(text) // 2],
    "empty": lambda _: "",
}


@pytest.mark.parametrize("how", CORRUPTED)
def test_a_corrupted_certificate_is_caught(how: str) -> None:
    """A changed text is refused, whatever the change."""
    [text] = [text for file, text in _proof().certificates.items() if file.startswith("pair-claim-step-")]
    corrupted = CORRUPTED[how](text)
    assert corrupted != text
    assert recheck("honest", text, 1) == ["unsat"]
    with pytest.raises(EngineError, match="cvc5"):
        recheck("corrupted", corrupted, 1)


@pytest.mark.usefixtures("without_yices")
def test_every_proof_calls_cvc5(monkeypatch: pytest.MonkeyPatch) -> None:
    """cvc5 decides each text of the verdict: ranges, lemmas and the property itself."""
    decided: list[str] = []

    def listening(file: str, text: str, **how: object) -> list[str]:
        decided.append(file)
        return decide(file, text, **how)  # type: ignore[arg-type]

    monkeypatch.setattr(module, "decide", listening)
    proof = _proof()
    certificates = proof.certificates
    assert sorted(decided) == sorted(certificates)
    assert proof.rechecked == (CVC5,)
    assert len(certificates) == 4


@needs_yices
def test_every_proof_calls_yices_and_none_cvc5(monkeypatch: pytest.MonkeyPatch) -> None:
    """What yices confirms is confirmed: every text of the verdict, and each text once."""
    asked: list[str] = []
    honest = yices.answers

    def listening(text: str, seconds: float, alone_seconds: float) -> list[str]:
        asked.append(text)
        return honest(text, seconds, alone_seconds)

    monkeypatch.setattr(yices, "answers", listening)
    monkeypatch.setattr(module, "recheck", lambda *_, **__: pytest.fail("cvc5 was asked"))
    proof = _proof()
    certificates = proof.certificates
    assert sorted(asked) == sorted(certificates.values())
    assert proof.rechecked == (f"yices {yices.version()}",)
    assert len(certificates) == 4


@needs_yices
@pytest.mark.parametrize("left", ["unknown", "(error: no such logic)"])
def test_cvc5_decides_what_yices_leaves_open(left: str, monkeypatch: pytest.MonkeyPatch) -> None:
    """Only those goals, and none is confirmed by nobody; the certificate is the one of all goals."""
    asked: list[str] = []

    def listening(file: str, text: str, expected: int, **how: object) -> list[str]:
        asked.append(text)
        return recheck(file, text, expected, **how)  # type: ignore[arg-type] # handed on as it came

    whole = certify(SOUND, seconds=10.0)
    assert confirmed_by({whole.file: whole.text}) == (f"yices {yices.version()}",)
    monkeypatch.setattr(yices, "answers", lambda *_: ["unsat", left])
    monkeypatch.setattr(module, "recheck", listening)
    again = certify(SOUND, seconds=10.0)
    assert again == whole
    assert confirmed_by({again.file: again.text}) == (f"yices {yices.version()}", CVC5)
    [text] = asked
    assert "above 0" in text and "above 2" not in text
    monkeypatch.setattr(module, "recheck", lambda *_, **__: ["unknown"])
    open_ = certify(SOUND, seconds=10.0)
    assert open_.undecided == ("above 0",)
    assert confirmed_by({open_.file: open_.text}) == ()


def test_a_text_keeps_its_names_on_the_way_to_another_process() -> None:
    """Results are pickled, and the text is that of before for everything else."""
    text = pickle.loads(pickle.dumps(ConfirmedText("(check-sat)", ("yices 2", "cvc5 1"))))
    assert (text, text.by) == ("(check-sat)", ("yices 2", "cvc5 1"))
    assert confirmed_by({"one": ConfirmedText("", ("cvc5 1",)), "two": text, "no query": "plain"}) == (
        "yices 2",
        "cvc5 1",
    )


def test_who_left_what_open_is_told_in_words() -> None:
    """Two programs did not both confirm the same; and by nobody is said of nothing."""
    assert rechecked_in_words("spacer", ("cvc5 1",)) == "spacer, re-checked by cvc5 1"
    told = rechecked_in_words("spacer", ("yices 2", "cvc5 1"))
    assert told == "spacer, re-checked by yices 2 and, for what it left open, cvc5 1"
    assert rechecked_in_words("construction", ()) == "construction"


@needs_yices
def test_a_text_without_its_goals_is_an_error(monkeypatch: pytest.MonkeyPatch) -> None:
    """yices has to answer each goal of the query."""
    monkeypatch.setattr(module, "to_smtlib", lambda query, *_: to_smtlib(query).replace("(push 1)", "", 1))
    with pytest.raises(EngineError, match="yices does not confirm the proof"):
        certify(SOUND, seconds=10.0)


def test_a_lying_encoding_is_caught(monkeypatch: pytest.MonkeyPatch) -> None:
    """If z3 gets a wrong question and says `proved`, the second solver reads the right one and contradicts."""
    monkeypatch.setattr(prover, "unproved", lambda *_: {})
    with pytest.raises(EngineError, match=r"(yices|cvc5) does not confirm the proof"):
        kinduction(goal(counter(), LEVEL <= 9), Limits())


def test_out_of_time_is_undecided_not_confirmed() -> None:
    """A goal for which cvc5 has no time is named as undecided."""
    assert certify(SOUND, seconds=0.0).undecided == ("above 2", "above 0")


HARD = """(set-logic QF_NIA)
(declare-const a Int)
(declare-const b Int)
(assert (and (> a 1) (> b 1) (= (* a b) 1000000016000000063)))
(check-sat)
"""


def test_a_question_broken_off_is_unknown() -> None:
    """If time ends within a question, cvc5 says `unknown (TIMEOUT)`: undecided, and no contradiction."""
    assert recheck("hard", HARD, 1, seconds=0.05) == ["unknown"]


def test_file_names_are_plain() -> None:
    """Any name of a property gives a portable file name, and one text has one name."""
    assert file_name("odometry: M1/M2 after 5 %", "") == "odometry--M1-M2-after-5---e3b0c44298fc1c14.smt2"
    assert file_name("a" * 999, "x").startswith("a" * 150 + "-")
    assert file_name("a/b", "one") != file_name("a/b", "two")


@pytest.mark.usefixtures("without_yices")
def test_a_goal_left_over_is_tried_alone(monkeypatch: pytest.MonkeyPatch) -> None:
    """A goal that cvc5 leaves undecided among others is asked for again, alone and with other options."""
    asked: list[tuple[int, bool]] = []

    def answers(file: str, text: str, expected: int, **how: object) -> list[str]:
        asked.append((expected, how.get("options") == module.ALONE))
        return ["unsat", "unknown"] if expected == 2 else recheck(file, text, expected, **how)  # type: ignore[arg-type]

    monkeypatch.setattr(module, "recheck", answers)
    assert certify(SOUND, seconds=10.0).undecided == ()
    assert asked == [(2, False), (1, True)]


@pytest.mark.usefixtures("without_yices")
def test_a_goal_alone_is_tried_in_rounds(monkeypatch: pytest.MonkeyPatch) -> None:
    """Each set of options has a second, then each four: one that does not suit the goal does not take the whole limit."""
    asked: list[tuple[float, dict[str, str]]] = []

    def answers(*_: object, seconds: float, options: dict[str, str]) -> list[str]:
        asked.append((seconds, options))
        return ["unsat"] if len(asked) == 5 else ["unknown"]

    monkeypatch.setattr(module, "recheck", answers)
    first = module.INDUCTION_OF_ONE_GOAL
    assert certify(Query("one", [X > 3], {"above 2": X > 2}), seconds=30.0, one_goal=first).undecided == ()
    sets = [first, module.ALONE, module.OPTIONS]
    assert asked == [*((1.0, one) for one in sets), *((4.0, one) for one in sets[:2])]


@needs_yices
@pytest.mark.parametrize("decides", ["yices at once", "cvc5 soon", "yices later", "cvc5 later"])
def test_an_induction_query_of_one_goal_is_asked_in_turn(decides: str, monkeypatch: pytest.MonkeyPatch) -> None:
    """yices and cvc5 look for a short time each, then for longer; who decides it is named alone."""
    asked: list[str] = []
    turns = ["yices at once", "cvc5 soon", "yices later", "cvc5 later"]

    def answered(*_: object, **__: object) -> list[str]:
        asked.append(turns[len(asked)])
        return ["unsat" if asked[-1] == decides else "unknown"]

    monkeypatch.setattr(yices, "answers", answered)
    monkeypatch.setattr(module, "recheck", answered)
    query = Query("one", [X > 3], {"above 2": X > 2})
    made = certify(query, seconds=30.0, one_goal=module.INDUCTION_OF_ONE_GOAL)
    assert made.undecided == ()
    assert asked == turns[: turns.index(decides) + 1]
    assert confirmed_by({made.file: made.text}) == (f"yices {yices.version()}" if "yices" in decides else CVC5,)
