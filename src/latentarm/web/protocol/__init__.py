"""What pages, server and arm process say to each other."""
