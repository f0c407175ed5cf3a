"""What a user feels of a latent action model, measured: on held-out episodes, per seed, with units."""
