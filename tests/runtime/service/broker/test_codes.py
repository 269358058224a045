"""The code of a report: it fits the topic and every byte, or the report is not used."""

from __future__ import annotations

import json
import re
from pathlib import Path

import pytest

from safeloc.errors import InputError
from safeloc.runtime.service.broker.codes import Codes
from safeloc.runtime.service.broker.settings import read_broker
from tests.runtime.service.broker.mosquitto import broker_file

KEY = bytes(range(32))
TEXT = b'{"vehicle": "12", "interval_mm": [1000, 2000]}'


def test_a_report_with_its_code() -> None:
    """It is one JSON object as before, with one field more."""
    made = Codes(KEY).added("fleet/reports/3/12", TEXT)
    assert json.loads(made) == {**json.loads(TEXT), "code": json.loads(made)["code"]}
    assert Codes(KEY).opened("fleet/reports/3/12", made) == TEXT


def test_any_change_is_seen() -> None:
    """Each bit, another topic, another key, none, and a second code."""
    made = Codes(KEY).added("fleet/reports/3/12", TEXT)
    for place in range(len(made)):
        for bit in range(8):
            changed = made[:place] + bytes([made[place] ^ 1 << bit]) + made[place + 1 :]
            assert Codes(KEY).opened("fleet/reports/3/12", changed) is None
    assert Codes(KEY).opened("fleet/reports/3/13", made) is None
    assert Codes(KEY[::-1]).opened("fleet/reports/3/12", made) is None
    assert Codes(KEY).opened("fleet/reports/3/12", TEXT) is None
    assert Codes(KEY).opened("fleet/reports/3/12", made + b"\n") is None
    assert Codes(KEY).opened("fleet/reports/3/12", made[:-1] + made[made.index(b', "code"') :]) is None


def test_the_key(tmp_path: Path) -> None:
    """It is in a file, long enough, and not told by the settings."""
    (tmp_path / "report.key").write_bytes(KEY)
    settings = read_broker("mqtt://localhost/fleet", broker_file(tmp_path, code_key_file="report.key"), {})
    assert settings.codes is not None
    assert settings.codes.opened("a", Codes(KEY).added("a", TEXT)) == TEXT
    assert KEY.hex() not in repr(settings)
    (tmp_path / "report.key").write_bytes(KEY[:31])
    with pytest.raises(InputError, match=r"report\.key: a key of 31 bytes can be guessed"):
        read_broker("mqtt://localhost/fleet", broker_file(tmp_path, code_key_file="report.key"), {})
    with pytest.raises(InputError, match=r"absent\.key: cannot be read"):
        read_broker("mqtt://localhost/fleet", broker_file(tmp_path, code_key_file="absent.key"), {})
    assert read_broker("mqtt://localhost/fleet", broker_file(tmp_path), {}).codes is None


def test_the_page_says_how(capsys: pytest.CaptureFixture[str]) -> None:
    """The program of docs/trackside.md makes a line whose code fits."""
    text = (Path(__file__).resolve().parents[4] / "docs" / "trackside.md").read_text(encoding="utf-8")
    program, *_ = re.findall(r"```python\n(.*?)```", text, re.DOTALL)
    exec(program, {})  # the page's own program
    line = capsys.readouterr().out.strip().encode()
    opened = Codes(bytes(32)).opened("areas/records/2/west", line)
    assert opened is not None
    assert json.loads(opened)["cycle"] == 1764279000
