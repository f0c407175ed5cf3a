"""One study of the paper per module, each with its ``DEFINITION``."""
