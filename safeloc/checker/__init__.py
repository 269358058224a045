"""A checker that is not the prover: reads a report folder and confirms each proof in it, or says why not.

dag      terms as shared nodes, with the one normal form in which they are compared
text     a certificate's text, read into nodes
terms    a declaration's terms, written as nodes
rules    what follows from which certificates, and in which order
claims   what each result of a report needs
walk     runs of one system, in the interpreter
solve    z3 and cvc5, and yices where it is installed, from the text
folder   the report folder: `check_folder`
proofs   what solvers are believed for elsewhere: unsat, step by step (a package of its own)

It imports nothing of safeloc.proof.provers and none of the translators of safeloc.codegen.
"""
