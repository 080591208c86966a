"""The commands `springtide`, `springtide run` and `springtide warmup`: one module each."""
