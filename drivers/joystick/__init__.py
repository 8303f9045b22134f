"""Joysticks and gamepads: through the Linux kernel, or through SDL."""
