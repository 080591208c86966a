"""The tasks that Springtide and its peers are both given."""
