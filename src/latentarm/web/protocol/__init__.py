"""Messages between pages, server and arm process."""
