"""Reflectors that balise groups anchor, in every composition that has both (RFL-5, RFL-6, RFL-9).

figures  what balise machine and reflector machine need of each other's figures
line     no machine on board: the map's next reflector, and the law on its distance from a group
wires    a group that the balise machine accepted is the reflector machine's reading, with that machine's interval
"""
