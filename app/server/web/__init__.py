"""Connections of browsers: their admission and limits, their page, and the flow of messages."""
