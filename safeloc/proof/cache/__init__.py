"""The cache of results, addressed by content: an unchanged proof is not repeated.

    store.py      files with a checksum, one for each cached item
    contents.py   digest of a target: everything on which its findings depend, and nothing else
    engine.py     digest of the verification code, and of the versions of solvers
    targets.py    findings of a target
    answers.py    answers of z3 and of yices or cvc5 to the text of a query: only "proved", and the hypotheses that a proof needs
    times.py      earlier running times of targets, to estimate the next ones
    reports.py    the complete report of a run, for a later run in which nothing has changed
    turns.py      locks, by which one of several processes asks a question and the others wait

No result is found by name: its key is a digest of everything on which it depends, and a file with a wrong checksum is
ignored. Undecided results are never cached.
"""
