"""The lab around the numerics: viewer, threads, the wall clock, files."""

import os

# Before numpy is first imported: its BLAS would meet a 32 x 32 eigenproblem with a thread a core, which spin while they
# wait; on a busy machine that turns 0.3 ms into 300.
os.environ.setdefault("OPENBLAS_NUM_THREADS", "1")
