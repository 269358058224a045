"""The long run of scripts against generated Python: it compares, goes on where it ended, and notices a wrong script."""

from __future__ import annotations

from pathlib import Path

import pytest

from tests.codegen import in_node, long_javascript
from tests.codegen.in_node import needs_node
from tests.kept_lines import kept_lines

pytestmark = needs_node


def _main(file: Path, *more: str) -> int:
    return long_javascript.main(["--steps", "1000", "--machine", "emitter", "--out", str(file), *more])


def test_it_ends_with_a_count_and_goes_on(tmp_path: Path, capsys: pytest.CaptureFixture[str]) -> None:
    """Two blocks of one machine, on board and with its world; started again, nothing is done twice."""
    file = tmp_path / "kept.jsonl"
    assert _main(file) == 0
    printed = capsys.readouterr().out.splitlines()
    assert printed[-2].startswith("1000 steps, 10 with the interpreter as well, ")
    assert printed[-1] == "2 passed, 0 failed"
    before = file.read_bytes()
    assert _main(file) == 0
    assert file.read_bytes() == before
    assert _main(file, "--seed", "2") == 0
    assert [1, 1, 2, 2] == [line["seed"] for line in kept_lines(file)]


def test_a_wrong_script_is_noticed(
    tmp_path: Path, capsys: pytest.CaptureFixture[str], monkeypatch: pytest.MonkeyPatch
) -> None:
    """One constant of the script changed: machine, block, step and the first difference are told, and the exit code is 1."""
    right = in_node.javascript
    old, new = "20n<=s[", "21n<=s["

    def wrong(*given: object, **named: object) -> str:
        text = right(*given, **named)  # type: ignore[arg-type]
        assert old in text
        return text.replace(old, new)

    monkeypatch.setattr(in_node, "javascript", wrong)
    assert _main(tmp_path / "kept.jsonl") == 1
    printed = capsys.readouterr().out
    assert "emitter, block 0, step " in printed
    assert " failed" in printed.splitlines()[-1]


@pytest.mark.thorough(ordinary=1)
@pytest.mark.parametrize("name", ["stop_point", "train_order"])
def test_machines_move(name: str) -> None:
    """The inputs are such that transitions fire: of each machine at least a third of its table within two blocks."""
    node = in_node.Node()
    try:
        benches = [long_javascript.bench(name, whole, node) for whole in (False, True)]
        fired = {one for on in benches for one in long_javascript.block(on, 0, seed=1).fired}
        (machine,) = benches[0].target.machines
    finally:
        node.close()
    assert len(fired) * 3 >= len(machine.transitions), sorted(fired)
