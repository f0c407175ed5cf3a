"""The isometric model: as far as the input is pushed, so far the tools move, anywhere."""
