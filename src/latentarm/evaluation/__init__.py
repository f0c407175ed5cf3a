"""Measures of latent action models that a user would notice, on held-out episodes, per seed, with units."""
