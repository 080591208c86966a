"""What the spring scenes share."""
