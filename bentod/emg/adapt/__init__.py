"""Following a wearer whose signals change in use, under guards: see `bentod.emg.adapt.adaptive`."""
