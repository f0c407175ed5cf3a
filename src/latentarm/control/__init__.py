"""Algorithm 1 online: one step, its safety filters, the loop, the recorder. NumPy alone."""
