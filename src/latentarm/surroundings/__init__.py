"""Where the things about an arm are: sources that see them, and what is believed of each."""
