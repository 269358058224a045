"""One declaration written out: Python, numpy, C99, FMI, z3 terms, SMT-LIB2, diagrams."""
