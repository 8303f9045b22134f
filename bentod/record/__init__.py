"""What a session leaves behind: recording, reading and repairing it."""
