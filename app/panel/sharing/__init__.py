"""Links, set-ups and comparisons that browsers share."""
