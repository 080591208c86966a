"""`springtide stability`: maps measured by letting every integrator run, beside what theory says of it."""
