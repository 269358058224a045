"""What enters the core is validated here and nowhere else: tables of rules, each with what it keeps out.

    machine.py       what a machine declares                            MACHINE
    composition.py   what a composition is asked to join, and gives     JOINING, JOINED
    system.py        what every prover and back end is handed           SYSTEM
    properties.py    a property by itself, and on a system              PROPERTY, READING, WATCHING
    table.py         all of them, for whoever wants to see them at once

What needs a solver (overlap, dead transitions, ranges) is an obligation, not a rule.
"""
