"""The how-to pages: what they say that a machine's proof prints is printed, and the remedy that they give works."""

from __future__ import annotations

import re
import shutil
from pathlib import Path

import pytest

from tests.cli.calling import DOOR_FILE, Call

PAGES = Path(__file__).parents[2] / "docs" / "howto"
SECONDS = ("--seconds", "2", "--jobs", "1")


def blocks(name: str) -> list[str]:
    """The programs of a page."""
    return re.findall(r"```python\n(.*?)```", (PAGES / f"{name}.md").read_text(encoding="utf-8"), re.DOTALL)


def written(folder: Path, name: str, text: str) -> str:
    """The address of a machine that was written into a file."""
    (folder / f"{name}.py").write_text(text, encoding="utf-8")
    return f"{folder / name}.py:machine"


@pytest.mark.thorough
def test_the_floor_is_undecided_and_says_why(call: Call, tmp_path: Path) -> None:
    """With a state that has one tile too few, and where to read on."""
    called = call("prove", written(tmp_path, "floor_undecided", blocks("undecided")[0]), *SECONDS)
    assert called.code == 3
    found = re.search(r"from a state with width = (\d+), height = (\d+), tiles = (\d+) lead to a bad one", called.out)
    assert found is not None
    width, height, tiles = map(int, found.groups())
    assert 4 * tiles <= (width + height) ** 2 and tiles != width * height
    assert "What to try: safeloc docs howto/undecided\n" in called.out


@pytest.mark.thorough(ordinary=1)
def test_the_lemma_makes_the_proof(call: Call, tmp_path: Path) -> None:
    """As the page adds it."""
    machine, lemma = blocks("undecided")
    before, _, after = machine.partition("machine = Machine(\n")
    text = f"{before}{lemma}machine = Machine(\n    lemmas=lemmas,\n{after}"
    called = call("prove", written(tmp_path, "floor_proved", text), "--seconds", "30", "--jobs", "1")
    assert called.code == 0, called.out
    assert "proved    floor/lemma/a tile in each place  [1-induction" in called.out


@pytest.mark.thorough
def test_a_wrong_lemma_does_no_harm(call: Call, tmp_path: Path) -> None:
    """It is violated, and the property is no more proved than without it."""
    machine, lemma = blocks("undecided")
    before, _, after = machine.partition("machine = Machine(\n")
    wrong = lemma.replace("product(width, height)", "product(width, width)")
    assert wrong != lemma
    text = f"{before}{wrong}machine = Machine(\n    lemmas=lemmas,\n{after}"
    called = call("prove", written(tmp_path, "floor_wrong", text), *SECONDS)
    assert called.code == 1
    assert "violated  floor/lemma/a tile in each place" in called.out


@pytest.mark.thorough
def test_the_assumption_of_the_door_ends(call: Call, tmp_path: Path) -> None:
    """The three findings of the page, and where to read on."""
    (door,) = blocks("empty_assumption")
    called = call("prove", written(tmp_path, "door_empty", door), *SECONDS)
    assert called.code == 1
    table = re.findall(r"^\| `(\w+) (door/[^`]*)` \|", (PAGES / "empty_assumption.md").read_text("utf-8"), re.MULTILINE)
    assert len(table) == 3
    for verdict, name in table:
        assert re.search(rf"^{verdict} +{re.escape(name)}  \[", called.out, re.MULTILINE)
    assert "What to try: safeloc docs howto/empty_assumption\n" in called.out


def test_without_the_law_the_door_is_proved(call: Call, tmp_path: Path) -> None:
    """The law that the page names is the one to blame."""
    (door,) = blocks("empty_assumption")
    without = re.sub(r' *"the train starts": .*\n', "", door)
    assert without != door
    called = call("prove", written(tmp_path, "door_proved", without), *SECONDS)
    assert called.code == 0, called.out
    assert "What to try" not in called.out


def test_commands_of_the_pages_exist(call: Call) -> None:
    """Each `safeloc WORD` of a page is a command, and each option of it is one."""
    said = {
        (command, option)
        for page in PAGES.glob("*.md")
        for command, rest in re.findall(
            r"(?:`|^    )safeloc ([a-z]+)((?: [^`\n]*)?)", page.read_text(encoding="utf-8"), re.MULTILINE
        )
        for option in re.findall(r"--[a-z-]+", rest) or [""]
    }
    assert ("recheck", "--proofs") in said
    for command, option in said:
        helped = call(command, "--help")
        assert helped.code == 0, command
        assert option in re.sub(r"\x1b\[[0-9;]*m", "", helped.out), (command, option)


@pytest.mark.thorough
@pytest.mark.parametrize(("job", "handed_over"), [(0, "safeloc.sarif"), (1, "safeloc.xml")])
def test_what_a_job_runs_writes_what_it_hands_over(
    call: Call, tmp_path: Path, monkeypatch: pytest.MonkeyPatch, job: int, handed_over: str
) -> None:
    """The file that the server reads, and the report that is kept, are there after the command."""
    jobs = re.findall(r"```yaml\n(.*?)```", (PAGES / "ci.md").read_text(encoding="utf-8"), re.DOTALL)
    assert len(jobs) == 2
    [command] = re.findall(r"- (?:run: )?safeloc (.+)", jobs[job])
    assert [handed_over] == re.findall(r"(?:sarif_file|junit): (.+)", jobs[job])
    assert re.search(r"path: report$|paths: \[report\]", jobs[job], re.MULTILINE)
    (tmp_path / "src").mkdir()
    shutil.copy(DOOR_FILE, tmp_path / "src" / "lamp.py")
    monkeypatch.chdir(tmp_path)
    called = call(*command.split())
    assert called.code == 0, called.out
    assert (tmp_path / handed_over).is_file() and (tmp_path / "report" / "index.html").is_file()
