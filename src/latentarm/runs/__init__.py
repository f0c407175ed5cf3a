"""A trained run as something to drive: what its folder says, its task, what steers it."""
