"""Sound, through whatever program plays it on this machine."""
