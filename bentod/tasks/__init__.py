"""Tasks in the plane of two joints: what they are, and how somebody gets on with one."""
