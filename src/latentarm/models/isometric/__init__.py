"""The isometric model: the tools move as far as the input is pushed, everywhere."""
