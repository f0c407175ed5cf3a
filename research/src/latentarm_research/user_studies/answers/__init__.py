"""What real people answered: sheets of items, their answers from a file, and scales of these."""
