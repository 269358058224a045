"""Tests of the choice of those cases that `make test` runs."""

from __future__ import annotations

import pytest

from tests.ordinary import by_test, ordinary

COLLECTED = """
import pytest

@pytest.mark.parametrize("case", range(9))
def test_unmarked(case): ...

@pytest.mark.parametrize("case", range(9))
@pytest.mark.thorough(ordinary=3)
def test_some(case): ...

@pytest.mark.thorough(ordinary=5)
@pytest.mark.parametrize("case", range(2))
def test_few(case): ...

@pytest.mark.thorough
def test_none(): ...

@pytest.mark.slow
def test_slow(): ...
"""


WITHOUT = ("-p", "no:cacheprovider", "-p", "no:unraisableexception")
"""No folder is left behind; and the second plugin would look, five times at the end, through all objects of the tests' process."""


class Kept:
    """Keeps what was collected."""

    items: list[pytest.Item]

    def pytest_collection_finish(self, session: pytest.Session) -> None:
        """Keep the items."""
        self.items = session.items


def collected(tmp_path_factory: pytest.TempPathFactory, text: str) -> list[pytest.Item]:
    """Return the cases of a file with this text."""
    folder, kept = tmp_path_factory.mktemp("collected"), Kept()
    file = folder / f"test_in_{folder.name}.py"  # a module of its own each time
    file.write_text(text)
    options = ["--collect-only", "-q", "--import-mode=importlib", "--rootdir", str(folder)]
    pytest.main([*options, *WITHOUT, str(file)], [kept])
    return kept.items


@pytest.fixture(scope="module")
def cases(tmp_path_factory: pytest.TempPathFactory) -> dict[str, list[str]]:
    """The ordinary cases of each test of the text."""
    tests = by_test(collected(tmp_path_factory, COLLECTED))
    return {of[0].name.partition("[")[0]: [case.name for case in ordinary(of)] for of in tests}


def test_all_cases_of_a_test_without_a_mark(cases: dict[str, list[str]]) -> None:
    """A test is ordinary unless it says otherwise."""
    assert [f"test_unmarked[{number}]" for number in range(9)] == cases["test_unmarked"]


def test_a_number_of_cases_is_spread(cases: dict[str, list[str]]) -> None:
    """Neighbours are often alike, so they are taken from all parts."""
    assert ["test_some[0]", "test_some[3]", "test_some[6]"] == cases["test_some"]


def test_a_number_greater_than_that_of_cases(cases: dict[str, list[str]]) -> None:
    """All are ordinary."""
    assert ["test_few[0]", "test_few[1]"] == cases["test_few"]


def test_none(cases: dict[str, list[str]]) -> None:
    """A thorough test without a number, and a slow one, are not ordinary at all."""
    assert ([], []) == (cases["test_none"], cases["test_slow"])


WRONG = ("thorough(3)", "thorough(ordinary=0)", "thorough(ordinary='all')", "thorough(usual=3)")


def test_a_mark_that_is_not_understood(tmp_path_factory: pytest.TempPathFactory) -> None:
    """It is refused with the test that has it."""
    tests = [f"@pytest.mark.{mark}\ndef test_odd_{number}(): ..." for number, mark in enumerate(WRONG)]
    found = by_test(collected(tmp_path_factory, "\n".join(["import pytest", *tests])))
    assert len(WRONG) == len(found)
    for number, items in enumerate(found):
        with pytest.raises(pytest.UsageError, match=f"test_odd_{number}: `thorough` takes `ordinary=`"):
            list(ordinary(items))
