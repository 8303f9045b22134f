"""Pattern recognition in use: decisions as samples arrive, guided collection, training beside the loop."""
