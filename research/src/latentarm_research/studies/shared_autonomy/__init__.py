"""The simulations of section 8.2: latent actions with shared autonomy, and with entropy over goals."""
