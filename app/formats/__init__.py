"""Forms in which numbers reach a reader: text, and fields of a surface packed into few bits. Needs no viewer."""
