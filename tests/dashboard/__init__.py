"""The page and its server: most of these share a daemon, a server and a browser, which end with them."""
