"""Values that viser's own types leave open."""

from typing import Any, TypeAlias

# A handle of a GUI element. Its value is a number, a text, a flag or a tuple; the kind of element decides.
GuiHandle: TypeAlias = Any
# Argument of viser's callbacks: a handle, and the browser that it came from (none where the program set a value).
ViserEvent: TypeAlias = Any
# A message of viser's protocol, in or out.
ViserMessage: TypeAlias = Any
# A connection, with viser's inner names on it.
ViserConnection: TypeAlias = Any
