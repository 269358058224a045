"""Pictures in the report: which runs are drawn, that a violation shows, and that the page still stands alone."""

from __future__ import annotations

import json
import re
from dataclasses import replace
from pathlib import Path
from typing import Any

import jsonschema
import pytest
from typer.testing import CliRunner

from safeloc.catalogue import load_target
from safeloc.cli.entry import app
from safeloc.errors import InputError
from safeloc.language.verdict import Violated
from safeloc.proof.verification.replay import replay_stream
from safeloc.railway.pictures import Approach, Deviation, Recognition, unreadable
from safeloc.report.data import report_data, schema
from safeloc.report.page import to_html
from safeloc.report.pictures import pictures_data, recorded_runs
from safeloc.runtime.packed import read_packed
from safeloc.runtime.streams.gzipped import name_of
from safeloc.runtime.streams.steps import read_steps, write_steps
from tests.report.drawing_reader import across, begin, drawing, kinds, points, upright, words
from tests.report.shipped_runs import changed, picture, recording, shipped

WRONG_FROM = 400
STEM = "reflector-figure-1"


@pytest.fixture(scope="module")
def violated(tmp_path_factory: pytest.TempPathFactory) -> dict[str, Any]:
    """Figure 1 as a vehicle records it, its truth 25 m beyond what it was from one step on."""
    folder = tmp_path_factory.mktemp("recorded")

    def shift(number: int, step: dict[str, Any]) -> dict[str, Any]:
        return {**step, "truth_mm": step["truth_mm"] + (25_000 if number >= WRONG_FROM else 0)}

    target = replace(shipped("reflector"), properties=())
    findings = replay_stream(target, changed("reflector", STEM, folder, shift))[1]
    return report_data(findings, [target])


def test_a_run_that_misses_the_truth_shows_it(violated: dict[str, Any]) -> None:
    """The violated statement is named and stands at its step, and a cross at each place that is wrong."""
    (drawn,) = violated["machines"][0]["pictures"]
    assert drawn["violated"] == ["truth"]
    of = drawing(drawn["svg"])
    assert f"× violated at step {WRONG_FROM}: truth" in words(of)
    (mark,) = kinds(of, "violated")
    wrong = [mark for mark in kinds(of, "wrong") if points(mark)[0][1] < 300]
    assert upright(of)(points(wrong[0])[0][1] + 6) == pytest.approx(-25, abs=1)
    assert across(of)(begin(wrong[0]) + 6) == pytest.approx(across(of)(begin(mark)), abs=0.5)


def test_the_page_names_what_the_picture_shows(violated: dict[str, Any]) -> None:
    """In the caption, beside the recording, before anybody looks at the curve."""
    page = to_html(violated)
    caption = page[page.index("<figcaption>") : page.index("</figcaption>")]
    assert STEM in caption
    assert '<span class="violated">violated: truth</span>' in caption


def test_data_with_pictures_obey_the_schema(violated: dict[str, Any]) -> None:
    """And give the same page when they are read back."""
    jsonschema.validate(violated, schema())
    assert to_html(json.loads(json.dumps(violated))) == to_html(violated)


def test_the_page_with_pictures_stands_alone(violated: dict[str, Any]) -> None:
    """No address but the name of the drawing format, no script, and every reference leads into the page."""
    page = to_html(violated)
    assert set(re.findall(r"https?://[^\s\"'<]*", page)) == {"http://www.w3.org/2000/svg"}
    assert not re.search(r"<(script|link|iframe|img|object|embed)\b|@import|url\((?!#)|\bon\w+=", page)
    ids = re.findall(r'\bid="([^"]*)"', page)
    assert set(re.findall(r"url\(#([^)]*)\)", page)) <= set(ids)
    assert len(ids) == len(set(ids))


@pytest.mark.parametrize(
    ("machine", "kind"), [("reflector", Deviation), ("stop_point", Approach), ("route", Recognition)]
)
def test_the_worked_figures_are_told(machine: str, kind: type) -> None:
    """Each of the three machines declares its figure, and its shipped recordings have one to be drawn of."""
    target = shipped(machine)
    assert [type(one) for one in target.pictures] == [kind]
    assert target.streams


def test_a_recording_of_ones_own_is_told_by_replay(tmp_path: Path) -> None:
    """`replay --out` writes a report of the one recording with its picture; the exit code is that of the replay."""
    path = tmp_path / "mine.jsonl"
    steps = read_steps(recording("route", "route-acd-every-reflector")).steps[:150]
    write_steps(path, steps, machine="route")
    folder = tmp_path / "told"
    done = CliRunner().invoke(app, ["replay", "route", str(path), "--format", "jsonl", "--out", str(folder)])
    assert done.exit_code == 0, done.output
    shown = json.loads(read_packed(folder / "machines" / "route.json.xz"))
    assert [one["recording"] for one in shown["pictures"]] == ["mine"]
    assert "recording <b>mine</b>" in (folder / "index.html").read_text(encoding="utf-8")


def test_every_route_recording_has_a_plan() -> None:
    """None is shown without the line it runs over; a stranger has none."""
    (declared,) = shipped("route").pictures
    assert isinstance(declared, Recognition)
    assert all(declared.plan(name_of(path)) is not None for path in shipped("route").streams)
    assert declared.plan("mine") is None


def test_a_run_is_drawn_once_whatever_is_found_on_it() -> None:
    """All findings of one replay share its run; what is no replay has none."""
    target = replace(shipped("route"), properties=shipped("route").properties[:3])
    findings = replay_stream(target, recording("route", "route-acd-every-reflector"))[1]
    assert len(findings) > 1
    assert len([*recorded_runs(target, findings)]) == 1
    assert len(pictures_data(target, findings)) == 1
    assert pictures_data(target, [replace(one, replayed=None) for one in findings]) == []
    assert pictures_data(replace(target, name="other"), findings) == []


def test_the_first_violation_stands_first() -> None:
    """Each violated statement with the step at which its run ends."""
    target = shipped("route")
    (one, *_) = replay_stream(replace(target, properties=()), recording("route", "route-acd-every-reflector"))[1]
    assert one.replayed is not None
    trace = one.replayed.trace
    late, early = (
        replace(
            one,
            id=f"route/replay/{one.replayed.name}: {name}",
            result=Violated(replace(trace, steps=trace.steps[:n]), ""),
        )
        for name, n in (("late", 70), ("a/b: early", 30))
    )
    (told,) = recorded_runs(target, [late, early])
    assert [(broken.name, broken.step) for broken in told.broken] == [("a/b: early", 30), ("late", 70)]


@pytest.mark.parametrize("machine", ["reflector", "stop_point", "route"])
def test_declared_pictures_can_be_read(machine: str) -> None:
    """Every signal that a shipped picture names is there, where it is looked for."""
    target = shipped(machine)
    assert [unreadable(one, target.system) for one in target.pictures] == [[]]


def test_a_wrong_name_is_told_before_anything_runs() -> None:
    """Also an input that may be absent where one is needed at every step."""
    target, one = shipped("stop_point"), picture("stop_point", Approach)
    wrong = replace(one, speed="sped", above="selected_stop", order="ordr")
    assert unreadable(wrong, target.system) == [
        "no input 'sped'",
        "input 'selected_stop' may be absent",
        "no output or state 'ordr'",
    ]


def test_an_old_name_is_told_the_new_one() -> None:
    """Of inputs, and of outputs."""
    approach, deviation = picture("stop_point", Approach), picture("reflector", Deviation)
    wrong = replace(approach, above="over_mm")
    assert unreadable(wrong, shipped("stop_point").system) == ["no input 'over_mm'; 'over_mm' is now 'margin_above_mm'"]
    wrong_too = replace(deviation, reported=replace(deviation.reported, below="under_mm"))
    told = unreadable(wrong_too, shipped("reflector").system)
    assert told == ["no output or state 'under_mm'; 'under_mm' is now 'margin_below_mm'"]


OWN = """
from safeloc.language.expr import number
from safeloc.language.machine import Machine, Transition, modes
from safeloc.railway.pictures import Deviation
from safeloc.reported import Reported
from safeloc.language.units import MM

(ON,) = modes("ON")
place = number("place_mm", MM, 0, 9)
kept = number("kept_mm", MM, 0, 9)
machine = Machine("own", modes=(ON,), inputs=[place], state={kept: 0}, outputs={"at_mm": kept}, transitions=[
    Transition("run", ON, ON, set={kept: place}),
])
pictures = [PICTURE]
"""


def test_a_user_declares_pictures(tmp_path: Path) -> None:
    """Beside the machine; one that names what is not there is refused, and so is what is no picture."""
    named = "Deviation('d', Reported('at_mm', 'at_mm', 'at_mm', 'VALID'), 30_000)"
    wrong = {
        named: "no output or state 'VALID'",
        "3": r"pictures holds 3 of type int; expected Deviation, Approach or Recognition",
    }
    for number, (declared, message) in enumerate(wrong.items()):
        path = tmp_path / f"own_{number}.py"
        path.write_text(OWN.replace("PICTURE", declared), encoding="utf-8")
        with pytest.raises(InputError, match=message):
            load_target(f"{path}:machine")
    path.write_text(OWN.replace("PICTURE", named.replace("VALID", "mode")), encoding="utf-8")
    assert [type(one) for one in load_target(f"{path}:machine").pictures] == [Deviation]


def test_a_machine_without_pictures_has_none() -> None:
    """Its page has no heading for them."""
    data = report_data([], [load_target("delocalized")])
    assert data["machines"][0]["pictures"] == []
    assert "Pictures of the replayed recordings" not in to_html(data)
