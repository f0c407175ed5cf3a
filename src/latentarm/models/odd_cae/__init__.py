"""The odd cAE: the odd part of a conditioned decoder, which rests and reverses by construction."""
