"""The drawing of the mooring."""
