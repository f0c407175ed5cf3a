"""The state-conditioned nonlinear model: an odd network of z whose weights depend on the context."""
