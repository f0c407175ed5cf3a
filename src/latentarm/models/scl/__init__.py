"""The state-conditioned linear model: linear in z, with a matrix that depends on the context."""
