"""The web server: who may speak to it, what it serves, and the socket that pages drive through."""
