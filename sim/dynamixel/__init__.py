"""A Dynamixel bus in bytes, with its own parser: it shares no codec with the driver."""
