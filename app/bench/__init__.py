"""Run time against error, frame costs, start-up, peers: one module a subject, each a list of rows."""
