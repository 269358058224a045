"""Links of a report's page: from a result to its certificates, its run and the source lines of its property; within the page."""

from __future__ import annotations

import re
import shlex
from collections import Counter
from collections.abc import Collection, Mapping, Sequence
from itertools import takewhile
from typing import Any
from urllib.parse import urlencode

from markupsafe import Markup, escape

_Data = Mapping[str, Any]
CERTIFICATES, TRACES = "certificates", "traces"
REPORT = "REPORT"
"""What stands for the folder of the report in a command that is not given in it."""
_OF_PARTS = ("transition", "law")
"""What is declared in a part, and is shown under the first target that has the part."""
_PART = re.compile(r"#\d+")
"""The name of a part of a term that the model does not name."""


def _beginning(texts: Sequence[str]) -> str:
    """Return what tells the certificates of a claim from others in their file: their name, or what their names begin with."""
    same = takewhile(lambda letters: len(set(letters)) == 1, zip(*texts, strict=False))
    return texts[0] if len(texts) == 1 else "".join(letters[0] for letters in same) + "*"


def anchor(*words: str) -> str:
    """Return the name of a place on the page."""
    return "-".join(re.sub(r"[^A-Za-z0-9]+", "-", word) for word in words)


def linked(text: str, to: str) -> Markup:
    """Return the text of a term in which the number of each named part leads to that part."""
    return Markup(_PART.sub(lambda found: f'<a href="#{to}-{found[0][1:]}">{found[0]}</a>', str(escape(text))))


def is_in_a_file(machine: _Data) -> bool:
    """Return whether the machine is one of a file, which is found from the folder in which it was asked for only."""
    return ".py:" in machine["spec"]


class Links:
    """The links of one page.

    data   of the report; `certificates` (file -> texts) and `runs` (result -> steps) are there if it lies in a folder
    files  machine -> name of its file of runs, without suffix
    """

    def __init__(self, data: _Data, files: Mapping[str, str]) -> None:
        self._files = files
        self._runs: Mapping[str, int] = data.get("runs", {})
        self._certified = set(data.get("certificates", {}))
        self._users = Counter(text for row in data["results"] for text in row["certificates"])
        self._file_of = {text: file for file, texts in data.get("certificates", {}).items() for text in texts}
        self._rows = {row["id"]: number for number, row in enumerate(data["results"])}
        self._places = {
            tuple(of): (one["place"], anchor("source", machine["name"], str(number)) if one["text"] else "")
            for machine in data["machines"]
            for number, one in enumerate(machine["declared"])
            for of in one["of"]
        }

    def row(self, row: _Data) -> str:
        """Return the place of a result on the page."""
        return f"r{self._rows[row['id']]}"

    def of(self, row: _Data) -> dict[str, Any]:
        """Return what the page needs to lead on from a result: its place, its evidence, and its source lines."""
        name = row["id"].split("/", 2)[-1]
        place, source = self._places.get(("property", row["machine"], name), ("", ""))
        return {
            "at": self.row(row),
            "evidence": [*self._certificates(row), *self._run(row)],
            "declared": place,
            "source": source,
        }

    def _certificates(self, row: _Data) -> list[tuple[str, str]]:
        """Return the file with the certificates of a result, and the beginning of the names of those that it alone has, if it has any.

        Reports of earlier versions have a file for each claim.
        """
        own: dict[str, list[str]] = {}
        for text in row["certificates"]:
            if self._users[text] == 1 and text in self._file_of:
                own.setdefault(f"{CERTIFICATES}/{self._file_of[text]}", []).append(text)
        return [(file, f"certificates {_beginning(texts)}") for file, texts in own.items()]

    def packed(self, machine: str) -> str:
        """Return the file with the certificates of a machine, with the suffix of this version or of earlier ones; nothing if there is none."""
        files = (f"{self._files[machine]}{suffix}" for suffix in (".texts.xz", ".tar.xz"))
        return next((f"{CERTIFICATES}/{file}" for file in files if file in self._certified), "")

    def _run(self, row: _Data) -> list[tuple[str, str]]:
        return [(at, f"run of {self._runs[row['id']]} steps")] if (at := self.run(row)) else []

    def run(self, row: _Data) -> str:
        """Return the place of the run of a result in the view of runs; nothing if it has none."""
        return f"#{urlencode({'result': row['id']})}" if row["id"] in self._runs else ""

    def run_file(self, row: _Data) -> str:
        """Return the file with the run of a result, from the folder of the report."""
        return f"{TRACES}/{self._files[row['machine']]}.js"

    def replay(self, row: _Data, machine: _Data) -> str:
        """Return the command that replays the run of a result, from the folder of the report; of a machine in a file from where that is found."""
        folder = f"{REPORT}/" if is_in_a_file(machine) else ""
        return shlex.join(["safeloc", "replay", machine["spec"], f"{folder}{self.run_file(row)}", "--run", row["id"]])

    def sources(self, machine: _Data, elsewhere: Collection[str]) -> dict[str, Any]:
        """Return the declarations of a target with their places on the page, and where to find each transition and law.

        elsewhere  parts that the page shows under another target, with their source lines
        """
        name = machine["name"]
        lines = [{**one, "at": anchor("source", name, str(number))} for number, one in enumerate(machine["declared"])]
        shown = [one for one in lines if not all(of[0] in _OF_PARTS and of[1] in elsewhere for of in one["of"])]
        lines = [one for one in shown if one["text"]]  # a file that could not be read has none, and no link leads there
        places = {
            kind: {(of[1], of[2]): one["at"] for one in lines for of in one["of"] if of[0] == kind}
            for kind in _OF_PARTS
        }
        return {"lines": lines, "transitions": places["transition"], "laws": places["law"]}
