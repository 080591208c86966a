"""A mooring from a MoorDyn file."""
