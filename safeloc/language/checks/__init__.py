"""All validation of declarations, in one place: tables of rules, each with the harm that it prevents.

    machine.py       the declaration of a machine                       MACHINE
    composition.py   the machines to compose, and the result             JOINING, JOINED
    system.py        the system handed to provers and back ends          SYSTEM
    properties.py    a property by itself, and on a system              PROPERTY, READING, WATCHING
    table.py         all rules in one list

A check that needs a solver (overlap, dead transitions, ranges) is an obligation, not a rule.
"""
