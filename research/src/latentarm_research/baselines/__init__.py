"""Published controllers that latent actions are compared with."""
