"""What a person means by their input: the alignment z = f(u, c), its priors, and the choice of questions."""
