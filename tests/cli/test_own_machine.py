"""A user's own machine, outside the package: proved, tested, replayed and reported; a wrong guard is found."""

from __future__ import annotations

import json
import subprocess
import sys
from pathlib import Path

import jsonschema
import pytest

from safeloc.report.data import schema
from tests.cli.calling import DOOR, DOOR_FILE, QUICK, QUICK_VERIFY, Call, wrong_door


def test_the_example_is_a_forty_line_file() -> None:
    """A useful machine fits on one screen."""
    assert len(DOOR_FILE.read_text(encoding="utf-8").splitlines()) - 5 <= 40


def test_all_holds(call: Call) -> None:
    """The door is proved: exit code 0, a line for each property."""
    called = call("prove", DOOR, *QUICK)
    assert called.code == 0
    for name in ("opens at speed", "clock at rest", "closes", "opens"):
        assert f"proved    door/property/{name}" in called.out


def test_wrong_guard(call: Call, tmp_path: Path) -> None:
    """Without the speed in the guard: exit code 1, and a run of one step that a person can read."""
    called = call("prove", wrong_door(tmp_path), "--property", "opens at speed", *QUICK)
    assert called.code == 1
    assert "violated  door/property/opens at speed" in called.out
    assert "   0  start  mode=LOCKED closing_for=0" in called.out
    last, why = called.out.splitlines()[-3:-1]
    assert f"Why: safeloc explain {tmp_path / 'wrong_door.py'}:machine 'opens at speed'" == why
    assert last.startswith("   1  open  [")
    assert "released=true" in last
    assert "mode=OPEN" in last


def test_counterexample_replays(call: Call, tmp_path: Path) -> None:
    """The saved trace of a violation, replayed, violates the same property; the right machine keeps it."""
    wrong = wrong_door(tmp_path)
    assert call("verify", wrong, "--out", str(tmp_path / "report"), *QUICK_VERIFY).code == 1
    trace = (str(tmp_path / "report" / "traces" / "door.js"), "--run", "door/property/opens at speed")
    again = call("replay", wrong, *trace)
    assert again.code == 1
    assert "opens at speed" in next(line for line in again.out.splitlines() if line.startswith("violated"))
    assert call("replay", DOOR, *trace).code == 0
    page = (tmp_path / "report" / "index.html").read_text(encoding="utf-8")
    assert (
        "Replay it from the folder in which you asked for this report, with its own folder in place of REPORT" in page
    )
    assert " REPORT/traces/door.js --run &#39;door/property/opens at speed&#39;" in page


RAILWAY = ("models.", "properties", "railway", "sensing", "simulation")
LOADED = """
import sys
from safeloc.cli import main
sys.argv = ["safeloc", "verify", *sys.argv[1:]]
try:
    main()
except SystemExit as ended:
    sys.stderr.write(" ".join([str(ended.code), *sorted(sys.modules)]))
"""


def test_a_users_machine_needs_nothing_of_the_railway(tmp_path: Path) -> None:
    """`verify` of it loads no machine that ships, no map, no sensor and no simulation."""
    command = [sys.executable, "-c", LOADED, DOOR, "--out", str(tmp_path / "report"), *QUICK_VERIFY]
    done = subprocess.run(command, capture_output=True, text=True, check=True)
    code, *modules = done.stderr.splitlines()[-1].split()
    assert "0" == code
    assert "safeloc.proof.verification.many" in modules
    assert [] == [name for name in modules if name.startswith(tuple(f"safeloc.{room}" for room in RAILWAY))]


def test_undecided(call: Call, tmp_path: Path) -> None:
    """A statement out of reach of the given limits is undecided: exit code 3."""
    path = tmp_path / "long.py"
    path.write_text(LONG, encoding="utf-8")
    called = call("prove", f"{path}:machine", "--property", "far", "--seconds", "0.1", "--depth", "1", "--jobs", "1")
    assert called.code == 3
    assert "unknown   long/property/far" in called.out


LONG = """
from safeloc.language.expr import TRUE, number, product
from safeloc.language.machine import Machine, Transition, modes
from safeloc.language.spec import never
from safeloc.language.units import COUNT
(ON,) = modes("ON")
a, b, c, d = (number(n, COUNT, 0, 1000) for n in "abcd")
u, v, w = (number(n, COUNT, 1, 1000) for n in "uvw")
machine = Machine("long", (ON,), [u, v, w, d], {a: 0, b: 0, c: 0}, {}, [
    Transition("go", ON, ON, TRUE, {a: u, b: v, c: w}),
])
properties = [never("far", (a > 2) & (product(product(a, a), a) + product(product(b, b), b)).eq(
    product(product(c, c), c)) & (b > 2))]
"""


@pytest.mark.thorough
def test_json_is_pure_and_valid(call: Call) -> None:
    """With --json standard output is one document of the published schema and standard error is empty."""
    called = call("prove", DOOR, "--json", *QUICK)
    data = json.loads(called.out)
    jsonschema.validate(data, schema())
    assert called.err == ""
    assert (data["schema"], data["verdict"]) == ("safeloc-report/5", "proved")
    assert [machine["name"] for machine in data["machines"]] == ["door"]


def test_a_shell_sees_the_same(tmp_path: Path) -> None:
    """In a process of its own, from another folder, by module name: the same verdict and exit code."""
    (tmp_path / "my_door.py").write_text(DOOR_FILE.read_text(encoding="utf-8"), encoding="utf-8")
    command = [sys.executable, "-c", "from safeloc.cli import main; main()", "prove", "my_door:machine", *QUICK]
    root = Path(__file__).parents[2]
    done = subprocess.run(
        command, cwd=tmp_path, env={"PYTHONPATH": str(root), "PATH": ""}, capture_output=True, text=True, check=False
    )
    assert done.returncode == 0, done.stderr
    assert "proved    door/property/opens at speed" in done.stdout
    assert "\x1b" not in done.stdout + done.stderr


@pytest.mark.parametrize("form", ["python", "mermaid", "dot", "svg", "table", "smtlib"])
def test_export(call: Call, form: str) -> None:
    """Every form of the door names its modes or its transitions."""
    called = call("export", DOOR, "--to", form)
    assert called.code == 0
    assert "closing_for" in called.out or "CLOSING" in called.out


def test_export_to_a_file(call: Call, tmp_path: Path) -> None:
    """--out writes the file and prints nothing."""
    path = tmp_path / "door.svg"
    assert call("export", DOOR, "--to", "svg", "--out", str(path)).out == ""
    assert path.read_text(encoding="utf-8").startswith("<svg")


SILENT = """
from safeloc.language.expr import boolean, optional
from safeloc.language.machine import Machine, Transition, modes
from safeloc.language.spec import always
from safeloc.language.units import MM

SHUT, OPEN = modes("SHUT", "OPEN")
seen, free = optional("seen_mm", MM, 0, 1_000), boolean("free")
machine = Machine("gate", (SHUT, OPEN), [seen, free], {}, {}, [Transition("open", SHUT, OPEN, ~seen.present)])
properties = [
    always("open when it is near", machine.mode.eq(OPEN).implies(seen.value <= 900)),
    always("shut when it is far", (seen.present & (seen.value > 900)).implies(machine.mode.eq(SHUT) | free | ~free)),
]
"""


def test_a_claim_that_reads_an_absent_input_is_violated(call: Call, tmp_path: Path) -> None:
    """With its place, the number that it reads, and the remedy; one that asks for the input first is not."""
    own = tmp_path / "gate.py"
    own.write_text(SILENT, encoding="utf-8")
    called = call("prove", f"{own}:machine")
    told = " ".join(called.out.split())
    assert 1 == called.code
    assert "violated gate/obligation/absence in claims" in told
    assert "the claim 'open when it is near'" in told and "gate.py:11) reads seen_mm while it is absent" in told
    assert "it is kept with the stored 0, and broken with" in told and "x.present.implies(...)" in told
    assert "'shut" not in told.partition("reads seen_mm while it is absent")[2]
