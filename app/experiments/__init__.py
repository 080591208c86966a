"""What sweep, stability and bench share: a process pool, tables and figures."""
