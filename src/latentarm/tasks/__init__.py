"""Tasks: where an arm starts, its goals, when it has succeeded, and a simulated demonstrator."""
