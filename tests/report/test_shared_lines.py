"""Texts by the lines that they have in common: every text comes back as it was, and nothing else is read."""

from __future__ import annotations

import pytest
from hypothesis import given
from hypothesis import strategies as st

from safeloc.report.shared_lines import FORMAT, shared_lines, texts_of

ONE = """; safeloc-certificate/1
(declare-const |x| Int)
(define-fun t0 () Int (+ |x| 1))
(define-fun t1 () Bool (< t0 5))
(assert t1)
(push 1)
(assert (not t1))
"""
OTHER = """; safeloc-certificate/1
(declare-const |x| Int)
(define-fun t0 () Int (- |x| 7))
(define-fun t1 () Int (+ |x| 1))
(define-fun t2 () Bool (< t1 5))
(assert t2)
"""
SHARED = """safeloc-certificates/2
 ; safeloc-certificate/1
 (declare-const |x| Int)
=Int (+ |x| 1)
=Bool (< t1 5)
!t1
 (push 1)
!(not t3)
\N{SPACE}
=Int (- |x| 7)
@one.smt2 0+7
@other.smt2 0+1 7 -6+2 3
"""
MOST = 10_000


def test_a_term_stands_once_whatever_its_number() -> None:
    """The second text has the same term under another number: it is not written again."""
    texts = {"one.smt2": ONE, "other.smt2": OTHER}
    assert shared_lines(texts) == SHARED
    assert texts_of(SHARED, MOST) == texts


PARTS = ["t0", "t1", "t2", "|t1|", "|", "(", ")", " ", "(define-fun ", " () Int ", "(assert ", "@", "=", "!", ";", "\N{LATIN SMALL LETTER E WITH ACUTE}", "t01", "at1"]  # fmt: skip
LINES = ["(define-fun t0 () Int 1)", "(define-fun t1 () Int (+ t0 |t0|))", "(define-fun t1 () Int 1)", "(assert t1)", "(assert t2)", ""]  # fmt: skip
ODD = st.lists(st.one_of(st.sampled_from(LINES), st.lists(st.sampled_from(PARTS)).map("".join), st.text(max_size=5)))


@given(st.lists(ODD.map("\n".join), max_size=4))
def test_every_text_comes_back_as_it_was(texts: list[str]) -> None:
    """Also one that is no certificate: names of terms that are not defined, defined twice or out of order, open bars."""
    named = {f"{number}.smt2": text for number, text in enumerate(texts)}
    assert texts_of(shared_lines(named), MOST) == named


@pytest.mark.parametrize(
    "content",
    [
        "",
        "safeloc-certificates/3\n",
        SHARED.replace(" 0+7", " 0+70"),
        SHARED.replace(" 0+7", " -1"),
        SHARED.replace(" 0+7", " 7+-7"),
        SHARED.replace(" 0+7", " one"),
        SHARED.replace("@other", "other"),
        SHARED.replace("@other", "@one"),
        SHARED.replace("!t1", "?t1"),
        SHARED.replace("!t1", "!t3"),
        SHARED.replace("\n \n", "\n\n"),
        SHARED.replace(" 0+7", " 0+7" * 100),
    ],
    ids=lambda content: str(len(content)),
)
def test_anything_else_is_refused(content: str) -> None:
    """Another version, lines that do not exist, references to what a text does not define, and texts without end."""
    with pytest.raises((ValueError, LookupError)):
        texts_of(content, MOST if content.count("0+7") < 9 else 1_000)


def test_the_format_is_named() -> None:
    """In the first line, also of no text at all."""
    assert shared_lines({}) == f"{FORMAT}\n"
    assert texts_of(f"{FORMAT}\n", 0) == {}
