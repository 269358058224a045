"""What one test of the machines has proved, no other one proves again: most of them begin with the lemmas of the same machines."""

from __future__ import annotations

import os
from collections.abc import Iterator

import pytest

from safeloc.proof.cache.answers import kept_in
from safeloc.proof.cache.store import Store


@pytest.fixture(scope="session")
def shared_answers(tmp_path_factory: pytest.TempPathFactory) -> Store:
    """Answers of solvers in this run of the tests, of all its processes."""
    own = tmp_path_factory.getbasetemp()
    return Store((own.parent if "PYTEST_XDIST_WORKER" in os.environ else own) / "answers")


@pytest.fixture(scope="module", autouse=True)
def asked_once(shared_answers: Store) -> Iterator[None]:
    """A question whose answer is `proved` is asked once in the run; what an edit changes is another question.

    Of a file, since the beginning looks at all files of the package.
    """
    with kept_in(shared_answers):
        yield
