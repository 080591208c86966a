"""A student's saved functions while a lab runs: versions, and the scenes that run by them."""
