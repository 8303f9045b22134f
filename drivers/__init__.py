"""Real hardware: what turns bentod's contracts into bytes on a wire."""
