"""The person's meaning of an input: the alignment z = f(u, c), its priors, and the choice of questions."""
