"""Bodies at rest: drafts, submerged parts and righting arms."""
