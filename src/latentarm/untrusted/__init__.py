"""What other people and programs wrote: read within bounds, and shown without being obeyed."""
