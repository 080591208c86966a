"""The tasks that Springtide and its peers are both given: a net, a reference solution, and our ladders of runs."""
