"""The commands `springtide`, `springtide run`, `springtide lab` and `springtide warmup`: one module each."""
