"""The lab in a notebook: `app.show` and its handle, and the entry of jupyter-server-proxy."""
