"""Pages on results: the one to hand in, and the teacher's."""
