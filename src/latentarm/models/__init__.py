"""Latent action models: a decoder ``a = phi(z, c)`` learned from demonstrations, behind one contract."""
