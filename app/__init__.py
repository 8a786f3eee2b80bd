"""The program: composes widgets and processing into windows, commands, devices and jobs."""
