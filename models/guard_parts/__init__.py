"""What the guard of a receiver is made of: its variables, the box it holds, the judgement on a fix, the law."""
