"""All validation of declarations, in one place: tables of rules, each with the harm that it prevents.

    machine.py       the declaration of a machine                             SHAPE, MACHINE
    composition.py   the machines to compose                                  JOINING
    system.py        every system that provers and back ends get              SYSTEM
    properties.py    a property by itself, on a system, and beside others     PROPERTY, READING, WATCHING
    terms.py         the terms of all of these
    table.py         all rules in one list

A check that needs a solver (overlap, dead transitions, ranges) is an obligation, not a rule.
"""
