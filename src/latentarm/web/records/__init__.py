"""What the page's server keeps: people, and every drive of theirs."""
