"""What the wearer, the clients and the limits make of each joint in this tick."""
