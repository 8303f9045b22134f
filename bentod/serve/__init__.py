"""The socket: how clients look at the arm and ask things of it."""
