"""A ball that is not there: sends a simulated or recorded run over a real wire and plays its sound, with faults."""
