"""Principal component analysis of the actions: the linear, context-free baseline of the paper."""
