"""The paper's autoencoders (equations 6 to 8), and the cAE with a penalty on motion at zero input."""
