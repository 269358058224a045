"""Streams and records: old names become those of today, all else stays letter by letter, doubt is refused."""

from __future__ import annotations

import json
import re
from pathlib import Path

import pytest

from safeloc.errors import StreamError
from safeloc.language.renamed import renamed
from safeloc.runtime.migration import migrate
from safeloc.runtime.streams.steps import read_steps, write_steps
from tests.runtime.migration.migrating import SHIPS, changed, migrated, no_machine

ROOT = Path(__file__).parents[3]
HEADER = {
    "schema": "safeloc-stream/1",
    "machine": "delocalized",
    "first": {"passed_over_mm": 3},
    "kept": ["source_over_mm"],
}


def test_steps(tmp_path: Path) -> None:
    """Each name in every line; spaces, order, values and lines without an old name are as they were."""
    made = migrated(
        tmp_path / "run.jsonl", '{"source_over_mm":3,  "truth_mm": 1.50}\n{"truth_mm": 4}\n{"source_over_mm": 5}\n'
    )
    assert (
        '{"source_margin_above_mm":3,  "truth_mm": 1.50}\n{"truth_mm": 4}\n{"source_margin_above_mm": 5}\n' == made.text
    )
    assert ["source_over_mm -> source_margin_above_mm (2 times, first in line 1)"] == changed(made)


def test_a_header(tmp_path: Path) -> None:
    """First values, and what the stream leaves out as kept."""
    made = migrated(tmp_path / "run.jsonl", json.dumps(HEADER) + "\n")
    header = json.loads(made.text)
    assert ({"passed_margin_above_mm": 3}, ["source_margin_above_mm"]) == (header["first"], header["kept"])
    assert "delocalized" == header["machine"]


def test_machines_of_a_composition(tmp_path: Path) -> None:
    """The name of the machine stays before that of its input."""
    made = migrated(tmp_path / "run.jsonl", '{"verification.fibre_under_mm": 3}\n')
    assert '{"verification.fibre_margin_below_mm": 3}\n' == made.text


def test_records(tmp_path: Path) -> None:
    """Of a record that tells a value, its name; other kinds have no such names."""
    record = '{"kind": "value", "time_ms": 5, "name": "fibre_over_mm", "value": 3}\n{"kind": "cycle", "time_ms": 100}\n'
    made = migrated(tmp_path / "records.jsonl", record)
    assert record.replace("fibre_over_mm", "fibre_margin_above_mm") == made.text


def test_a_packed_stream_is_what_its_writer_makes(tmp_path: Path) -> None:
    """To the byte, and it is read as the same steps."""
    old, new = tmp_path / "run.jsonl.gz", tmp_path / "new.jsonl.gz"
    write_steps(old, [{"source_over_mm": 3}, {"source_over_mm": 4}], machine="delocalized", short=True)
    write_steps(new, [{"source_margin_above_mm": 3}, {"source_margin_above_mm": 4}], machine="delocalized", short=True)
    made = migrate(old, ships=SHIPS, fingerprint=no_machine)
    written = made.write(in_place=False)
    assert tmp_path / "run.migrated.jsonl.gz" == written
    assert new.read_bytes() == written.read_bytes()
    assert read_steps(new).steps == read_steps(written).steps


@pytest.mark.parametrize("text", ['{"source_margin_above_mm": 3, "overlap_mm": 4}\n', "", '{"truth_mm": 3}\n'])
def test_a_stream_of_today_is_left_alone(tmp_path: Path, text: str) -> None:
    """Nothing is changed, so nothing is written."""
    assert () == migrated(tmp_path / "run.jsonl", text).changes


@pytest.mark.parametrize(
    ("text", "message"),
    [
        ('{"a": 1}\n{"b"\n', ":2: not JSON"),
        ('{"over_mm": 1, "margin_above_mm": 1}\n', ":1: has both 'over_mm' and 'margin_above_mm', an old name"),
        ('{"over_mm": 1, "lead": "over_mm"}\n', ":1: has ['over_mm'] as a value as well; change the line by hand."),
        (
            '{"schema": "safeloc-stream/1", "machine": "crane", "kept": ["over_mm"]}\n',
            ":1: a stream of 'crane', which is no shipped machine, so its names are unknown here.",
        ),
        (
            '{"position.fix_protection_mm": 5000}\n',
            ":1: has 'position.fix_protection_mm', which is now 'position.fix_dilution_permille' and "
            "'position.fix_further_mm': these cannot be derived from the old figure. Record the stream again.",
        ),
        (
            '{"schema": "safeloc-stream/9"}\n',
            ":1: schema is 'safeloc-stream/9'; only 'safeloc-stream/1' can be converted.",
        ),
        ('{"schema": "safeloc-stream/1", "first": 3}\n', ":1: `first` must be an object of initial values"),
        ('{"schema": "safeloc-stream/1", "kept": [3]}\n', ":1: `first` must be an object of initial values"),
        ('{"kind": "smoke", "time_ms": 1}\n', ":1: a line of kind 'smoke'; known are ['cycle', 'distance',"),
        ('{"cycle": 3, "interval_mm": null}\n', ":1: a report of a process; nothing reads it"),
        ('{"event": "refused", "line": 17}\n', ":1: a report of a process; nothing reads it"),
    ],
)
def test_what_is_not_understood_is_refused(tmp_path: Path, text: str, message: str) -> None:
    """With file, line and reason."""
    path = tmp_path / "run.jsonl"
    with pytest.raises(StreamError, match=rf"^{re.escape(str(path) + message)}"):
        migrated(path, text)


def test_the_names_of_a_machine_that_does_not_ship_are_its_owners(tmp_path: Path) -> None:
    """A stream without an old name is one of today, whosever it is."""
    assert () == migrated(tmp_path / "run.jsonl", '{"schema": "safeloc-stream/1", "machine": "crane"}\n').changes


def test_inputs_that_another_machine_gives_now_are_refused(tmp_path: Path) -> None:
    """A reflector's readings beside balises, which anchor it now; without balises they are inputs as before."""
    reading = '{"reflector.balise_position_mm": 320000, "reflector.route_contradicted": false}\n'
    alone = migrated(tmp_path / "alone.jsonl", reading)
    assert (reading, []) == (alone.text, changed(alone))
    with pytest.raises(
        StreamError,
        match=r"both\.jsonl:1: has 'reflector\.balise_position_mm', .* the balise machine gives it\. Record .*migrating\.md",
    ):
        migrated(tmp_path / "both.jsonl", reading + '{"balise.telegram_group": 3}\n')


def test_a_machine_says_who_gives_a_former_input_now() -> None:
    """As it refuses the stream: another machine's input of the same meaning, or the machine that gives it."""
    localizer = ["reflector.frame_present", "line.next_position_mm", "balise.telegram_group"]
    assert "; 'reflector.next_position_mm' is now 'line.next_position_mm'" == renamed(
        ["reflector.next_position_mm"], localizer
    )
    said = "; 'reflector.balise' is no input any more, the balise machine gives it (docs/migrating.md)"
    assert said == renamed(["reflector.balise"], localizer)
    assert "" == renamed(["reflector.balise", "reflector.next_position_mm"], ["front_wheel_mm"])


OF_COMPOSITIONS = (
    "localizer",
    "localizer_sections",
    "localizer_track",
    "reflector_device",
    "fibre_area",
    "counted_entry",
)


@pytest.mark.parametrize("name", OF_COMPOSITIONS)
def test_the_recordings_of_compositions_have_the_current_names(name: str) -> None:
    """What is wired in one composition may be an input of another: none of what ships is refused or changed."""
    paths = sorted((ROOT / "models" / name / "recordings").glob("*.jsonl.gz"))
    found = [migrate(path, ships=SHIPS, fingerprint=no_machine) for path in paths]
    assert paths and [one.changes for one in found] == [()] * len(paths)
