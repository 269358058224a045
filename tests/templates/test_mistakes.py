"""The README of each template says which mistake gives which message: every line of its table is tried."""

from __future__ import annotations

import re
import shutil
from pathlib import Path

import pytest

from safeloc.templates.project import TEMPLATES
from tests.cli.calling import Call

ROOT = Path(__file__).parents[2] / "safeloc" / "templates"
MISTAKES = {
    "machine": {
        "reads 'truth_nm'; it may read only inputs and state": ("LOCATED, marker.present,", "LOCATED, marker.present & (truth > 0),"),
        "cannot add um and mm. Convert one with floor_to, ceil_to or exact_to": (
            "ceil_div(exact_to(wheel.value, UM) *", "ceil_div(wheel.value *"
        ),
        "reads 'margin_um', which the machine computes": (
            "wheel.present.implies(wheel_error", "(wheel.present & (margin > 0)).implies(wheel_error"
        ),
        "violated  odometer/lemma/the margin covers the error": ("margin + ceil_div(", "margin + floor_div("),
        "both are enabled when mode = LOCATED": ("~wheel.present, {place: 0, margin: 0}, rank=1", "~wheel.present, {place: 0, margin: 0}, rank=0"),
        "violated  odometer/obligation/absence": (
            '        Transition("no reading", LOCATED, LOST, ~wheel.present, {place: 0, margin: 0}, rank=1),\n', ""
        ),
        "violated  odometer/obligation/transition odometer: too uncertain": ("LOST, set={place: 0,", "LOST, grown < 0, set={place: 0,"),
        "vacuous   odometer/property/kept while it is good": (
            "(was_located & wheel.present &", "(was_located & wheel.present & (before(margin) > 6_000_000) &"
        ),
        "not asked odometer/property/nothing asked": ("\nproperties = [", "\nproperty_list = ["),
        "no such file, but odometer.recordings names it": ('["recordings/run.jsonl"]', '["recordings/gone.jsonl"]'),
    },
    "composition": {
        "violated  supervised_speed/lemma/speedometer: the bound is a bound": ("minimum(bound + GAIN_MM_S, FASTEST_MM_S)", "bound"),
        "violated  supervised_speed/lemma/contract of supervisor holds": ("minimum(bound + GAIN_MM_S, FASTEST_MM_S)", "bound"),
        "a wire reads machines listed before": ("[speedometer, supervisor],", "[supervisor, speedometer],"),
        "reads the ghost 'speed_mm_s'; let it read on-board variables only": (
            'speed_bound: speedometer.output("bound_mm_s")', "speed_bound: speed"
        ),
        "violated  supervised_speed/property/supervisor: released while it may be fast": (
            "may_release = released & (speed_bound <= RELEASE_MM_S)", "may_release = released"
        ),
        "violated  supervised_speed/property/too fast, so it brakes": (
            'BRAKING, FREE = supervisor_modes = modes("BRAKING", "FREE")', 'FREE, BRAKING = supervisor_modes = modes("FREE", "BRAKING")'
        ),
    },
    "source": {
        "violated  beacons/property/the interval holds the front end": ("RANGING_MM + run", "RANGING_MM"),
        "violated  beacons/property/the interval holds the front end ": ("{margin: wider}", "{margin: margin}"),
        "violated  beacons/property/a reason is stated": ("ite(valid, LOCATED, SENSOR_FAILURE)", "SENSOR_FAILURE"),
        "violated  beacons/property/a reference comes with an interval": (
            '"reference_accepted": valid & margin.eq(fresh)', '"reference_accepted": ~valid'
        ),
        "violated  beacons/property/the interval is in range": ("100, 300, 45_000", "100, 300, 450_000"),
        "has no output 'reason'; a source states it, a member of REASON": (
            '            "reason": ite(valid, LOCATED, SENSOR_FAILURE),\n', ""
        ),
        "output 'valid' of machine 'beacons' must be a truth value": ('"valid": valid,', '"valid": margin,'),
    },
}  # fmt: skip
"""Message -> what stands in the template, and what the mistake makes of it."""


@pytest.mark.parametrize("template", TEMPLATES)
def test_every_message_of_the_readme_is_tried(template: str) -> None:
    """The second column of the table, and nothing else."""
    table = (ROOT / template / "README.md").read_text(encoding="utf-8").split("| mistake | message |")[1]
    rows = [line for line in table.split("\n\n")[0].splitlines()[2:] if line]
    assert [message.strip() for message in MISTAKES[template]] == [
        re.findall(r"`([^`]+)`", row.split(" | ")[-1])[0] for row in rows
    ]


CASES = [(template, message) for template, messages in MISTAKES.items() for message in messages]


@pytest.mark.thorough(ordinary=1)
@pytest.mark.parametrize(("template", "message"), CASES, ids=[message[:40] for _, message in CASES])
def test_the_mistake_gives_the_message(call: Call, tmp_path: Path, template: str, message: str) -> None:
    """As the README says, word for word, and no exit code that could be taken for good."""
    chosen, (right, wrong) = TEMPLATES[template], MISTAKES[template][message]
    text = (ROOT / template / f"{chosen.module}.py").read_text(encoding="utf-8")
    assert 1 == text.count(right)
    path = tmp_path / f"{chosen.module}.py"
    path.write_text(text.replace(right, wrong), encoding="utf-8")
    if (ROOT / template / "recordings").is_dir():
        shutil.copytree(ROOT / template / "recordings", tmp_path / "recordings")
    called = call("prove", chosen.target_in(tmp_path), "--seconds", "2", "--jobs", "1")
    assert called.code in (1, 2, 3)
    assert message.strip() in called.out + called.err
