"""What was found before, kept by content: an unchanged question is not asked twice.

    store.py      files with a checksum, one for each answer
    contents.py   digest of a target: all that its findings depend on, and nothing else
    engine.py     digest of the code that decides, and of the versions of solvers
    targets.py    findings of a target
    answers.py    what z3 and cvc5 have answered to the text of a query: only ever that it is proved
    times.py      how long targets took, to say how long they will
    reports.py    the whole report of a run in which nothing has changed

Nothing that is kept is trusted for its name: it is found under a digest of everything that it depends on, and a file whose
checksum is wrong is as good as none. What was not decided is never kept.
"""
