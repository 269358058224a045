"""A checker independent of the provers: it reads a report folder, and confirms each proof in it or gives the reason why not.

dag       terms as shared nodes, in one normal form for comparison
text      a certificate's text, read into nodes
terms     a declaration's terms, written as nodes
rules     the conclusion of each certificate, and the facts that it may use
instance  admissible inputs in every state, by witness functions
claims    the certificates that each result of a report needs
runs      the runs that results of a report need
walk      runs of one system, computed from nodes
solve     answers of z3 and cvc5, and of yices if it is installed
answer    the answer about one result
folder    the report folder: `check_folder`
unsat     the proofs of all certificates in a folder, without trust in a solver
proofs    cvc5's proofs of `unsat`, checked step by step (a package of its own)

It imports nothing of safeloc.proof.provers and none of the translators of safeloc.codegen.
"""
