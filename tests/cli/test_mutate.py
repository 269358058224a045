"""`safeloc mutate`: lines for people, JSON for programs, and what was judged before."""

from __future__ import annotations

import json
from pathlib import Path

from safeloc.assurance.mutation.kept_score import SCORES
from safeloc.catalogue import load_target
from safeloc.proof.cache.store import Store
from tests.cli.calling import Call

SPEC = "tests.assurance.mutation.brake:machine"


def test_lines(call: Call, tmp_path: Path) -> None:
    """The score in both ways, who notices alone, and each question with its place and term."""
    called = call("mutate", SPEC, "--cache", str(tmp_path))
    assert 0 == called.code
    assert "the term wrong wherever it stands: " in called.out
    assert "the machine alone wrong: " in called.out
    assert "only range brakings notices" in called.out
    assert "written: self.speed > LIMIT_MM_S" in called.out
    alone = call("mutate", SPEC, "--cache", str(tmp_path), "--machine-only")
    assert "the term wrong wherever it stands: " not in alone.out


def test_json_of_a_sample(call: Call, tmp_path: Path) -> None:
    """So many mutants as asked for, and the same again from what was kept; its score is kept for reports, not that of one mutant."""
    command = ("mutate", SPEC, "--sample", "5", "--seed", "2", "--cache", str(tmp_path), "--json")
    first, again = (json.loads(call(*command).out) for _ in range(2))
    assert ("safeloc-mutation/1", 5) == (first["schema"], first["judged"])
    assert first["results"] == again["results"]
    [one] = json.loads(call(*command, "--mutant", first["results"][0]["id"]).out)["results"]
    assert first["results"][0] == one
    kept = SCORES.of_targets(Store(tmp_path), [load_target(SPEC)])["brake"]
    assert (5, first["everywhere"]["killed_by_proof"]) == (kept["judged"], kept["by_proof"])


def test_an_unknown_mutant(call: Call, tmp_path: Path) -> None:
    """Exit code 2, and where ids are listed."""
    called = call("mutate", SPEC, "--mutant", "brake-0", "--cache", str(tmp_path))
    assert 2 == called.code
    assert "no mutant 'brake-0'; --json lists them" in called.err


def test_the_world(call: Call, tmp_path: Path) -> None:
    """Clauses made wrong, which way each went, and what it asks too much."""
    called = call("mutate", "tests.assurance.mutation.gate:machine", "--of", "world", "--cache", str(tmp_path))
    assert 0 == called.code
    assert "a clause of the world wrong: " in called.out
    assert "asks for more than the claims need (all claims are proved in the weaker world): gate-" in called.out
    assert "[weaker]" in called.out


def test_the_world_of_a_composition(call: Call) -> None:
    """Exit code 2, with the machines to give instead."""
    called = call("mutate", "supervised_odometry", "--of", "world")
    assert 2 == called.code
    assert "supervised_odometry is a composition: only its machines and wires are made wrong." in " ".join(
        called.err.split()
    )
    assert "odometry, delocalized" in " ".join(called.err.split())


def test_written_reasons(call: Call, tmp_path: Path) -> None:
    """A survivor is told with the reason that a file gives; a reason for what there is not is refused with exit code 2."""
    command = ("mutate", SPEC, "--sample", "12", "--cache", str(tmp_path))
    [open_, *_] = json.loads(call(*command, "--json").out)["without_reason"]
    file = tmp_path / "why.toml"
    file.write_text(f'[[machine]]\nmutants = ["{open_}"]\nreason = "Nothing safe rests on what is counted here."\n')
    told = call(*command, "--reasons", str(file))
    assert 0 == told.code
    assert "1 with a written reason" in told.out
    assert "REASON: Nothing safe rests on what is counted here." in told.out
    assert open_ not in json.loads(call(*command, "--reasons", str(file), "--json").out)["without_reason"]
    file.write_text(file.read_text().replace(open_, "brake-0"))
    stale = call(*command, "--reasons", str(file))
    assert 2 == stale.code
    assert "there is no mutant 'brake-0' of the machine any more" in " ".join(stale.err.split())
