"""The parts of a net that are near to each other: particles, links, edges and faces."""
