"""The page that shows the arm in a browser: a process of its own, a client of the socket like any other."""
