"""A conditional flow over actions, of whose dimensions d are steered and the others held at zero."""
