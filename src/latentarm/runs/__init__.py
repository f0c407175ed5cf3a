"""A trained run: training it, what its folder says, what steers by it, what people mean by their input."""
