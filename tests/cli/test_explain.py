"""`safeloc explain`: each verdict is told with what it rests on; wrong names and files are refused."""

from __future__ import annotations

import json
from pathlib import Path

import pytest

from tests.cli.calling import Call
from tests.started_pytest import run_pytest

LIFT = """
from safeloc.language.expr import boolean, number
from safeloc.language.machine import Machine, Transition, modes
from safeloc.language.spec import always, never, reachable
from safeloc.language.units import COUNT

OFF, ON = modes("OFF", "ON")
go, level, twin = boolean("go"), number("level", COUNT, 0, 100), number("twin", COUNT, 0, 100)
machine = Machine(
    name="lift", modes=(OFF, ON), inputs=[go], state={level: 0, twin: 0}, outputs={"level": level},
    transitions=[
        Transition("start", OFF, ON, go),
        Transition("rise", ON, ON, level < 9, {level: level + 1, twin: twin + 1}, rank=0),
        Transition("end", ON, OFF, level >= 9, {level: 0, twin: 0}, rank=1),
    ],
)
properties = [
    never("level 4", level > 3, requirements=("MRK-1",)),
    always("level is low", level <= 9),
    reachable("runs", machine.mode.eq(ON)),
    never("twin is high", twin > 20),
]
"""


@pytest.fixture
def lift(tmp_path: Path, monkeypatch: pytest.MonkeyPatch) -> str:
    """The address of a user's machine in the present folder."""
    monkeypatch.chdir(tmp_path)
    Path("lift.py").write_text(LIFT, encoding="utf-8")
    return "lift.py:machine"


def test_a_violation_is_told_with_inputs_term_and_test(call: Call, lift: str) -> None:
    """The exit code is that of `prove`; the test file fails on the machine as it is, and passes once it is mended."""
    called = call("explain", lift, "level 4", "--pytest", "test_lift.py")
    assert (called.code, called.err) == (1, "test: test_lift.py\n")
    for line in ("     1  start  [go=true]", "     5  rise  []", "level = 4", "requirements: MRK-1"):
        assert line in called.out
    assert _pytest() == 1
    Path("lift.py").write_text(
        LIFT.replace("level < 9", "level < 3").replace("level >= 9", "level >= 3"), encoding="utf-8"
    )
    assert _pytest() == 0


def _pytest() -> int:
    return run_pytest("-q", "test_lift.py").returncode


def test_an_existing_file_is_not_written_over(call: Call, lift: str) -> None:
    """Nor is a file written where no run violates the property."""
    Path("mine.py").write_text("mine", encoding="utf-8")
    called = call("explain", lift, "level 4", "--pytest", "mine.py")
    assert (called.code, Path("mine.py").read_text(encoding="utf-8")) == (2, "mine")
    assert "mine.py exists; give another file" in called.err
    called = call("explain", lift, "level 4", "--pytest", "none/test_lift.py")
    assert (called.code, "none/test_lift.py: cannot be written" in called.err) == (2, True)
    called = call("explain", lift, "runs", "--pytest", "other.py")
    assert called.code == 0
    assert "The run that shows it" in called.out
    assert "no run that violates 'runs' was found; other.py is not written" in called.err
    assert not Path("other.py").exists()


def test_a_proof_is_told_with_what_it_rests_on(call: Call, lift: str) -> None:
    """The rows that it needs, and that no mutant was judged."""
    called = call("explain", lift, "level is low")
    assert called.code == 0
    assert "proved: 1-induction" in called.out
    assert "lift: rise" in called.out
    assert "not measured: `safeloc mutate lift.py:machine`" in called.out


def test_a_reached_state_is_told_with_its_run(call: Call, lift: str) -> None:
    """The run is the evidence."""
    called = call("explain", lift, "runs")
    assert called.code == 0
    assert "the shortest run to it has 1 steps" in called.out
    assert "The run that shows it" in called.out


def test_an_undecided_property_is_told_with_a_lemma(call: Call, lift: str, monkeypatch: pytest.MonkeyPatch) -> None:
    """Without Spacer and with no time for more, induction alone leaves it open; the lemma makes it inductive."""
    from safeloc.proof.provers import portfolio

    monkeypatch.setattr(portfolio, "_ENGINES", portfolio._ENGINES[:1])
    called = call("explain", lift, "twin is high")
    assert called.code == 3
    assert "The row that leads out: rise" in called.out
    assert "With these as lemmas it is inductive" in called.out
    assert "twin" in called.out.split("With these as lemmas")[1]


def test_as_data(call: Call, lift: str) -> None:
    """The same sections, and the run as a stream."""
    called = call("explain", lift, "level 4", "--json")
    data = json.loads(called.out)
    assert (called.code, data["schema"], data["id"]) == (1, "safeloc-explanation/1", "lift/property/level 4")
    assert len(data["run"]["steps"]) == 5
    assert "What it says" in [one["heading"] for one in data["sections"]]


def test_an_unknown_name_is_refused_with_the_nearest(call: Call, lift: str) -> None:
    """The message says where the names are listed."""
    called = call("explain", lift, "level 5")
    assert called.code == 2
    text = " ".join(called.err.replace("│", " ").split())
    assert (
        "lift has no property 'level 5'; `safeloc list properties lift.py:machine` lists them. Did you mean 'level 4'?"
        in text
    )


def test_what_a_shipped_claim_assumes(call: Call) -> None:
    """The laws of its world by name, and the claim with the names of outputs."""
    called = call("explain", "axle_head", "every axle is counted")
    assert called.code == 0
    assert "safeloc list assumptions axle_head" in called.out
    assert "axle_head: " in called.out


CONTRADICTING = """
from safeloc.language.expr import boolean
from safeloc.language.machine import Machine, Transition, modes
from safeloc.language.spec import never
from safeloc.language.world import World

OFF, ON = modes("OFF", "ON")
go = boolean("go")
machine = Machine(
    "lamp", (OFF, ON), [go], {}, {}, [Transition("on", OFF, ON, go)], world=World(clauses={"go": go, "stay": ~go})
)
properties = [never("lit", machine.mode.eq(ON))]
"""


def test_a_proof_under_laws_that_exclude_each_other_is_told_as_empty(call: Call, tmp_path: Path) -> None:
    """First of all, and with the exit code of what does not hold."""
    (tmp_path / "lamp.py").write_text(CONTRADICTING, encoding="utf-8")
    told = call("explain", f"{tmp_path}/lamp.py:machine", "lit")
    assert 1 == told.code
    first = told.out.index("The proof may be empty: its assumption\n  violated: the assumption can be satisfied")
    assert first < told.out.index("What it says")
