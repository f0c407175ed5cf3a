"""What the commands do: one module each, configuration in, rows and figures out."""
