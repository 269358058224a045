"""What the balise machine is made of."""
