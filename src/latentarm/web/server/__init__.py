"""The web server: access control, pages and assets, and the socket that pages drive through."""
