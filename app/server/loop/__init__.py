"""The simulation thread: commands, runs, snapshots and clocks of one scene."""
