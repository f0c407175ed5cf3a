"""Tasks: an arm's start, its goals, success, and a simulated demonstrator."""
