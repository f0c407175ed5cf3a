"""Algorithm 1 online, behind its safety filters: NumPy alone, neither torch nor MuJoCo."""
