"""Wine, in which the tests of Windows run on Linux, is not Windows."""

import ctypes
import sys

import pytest


def is_wine() -> bool:
    """True in a Python for Windows under Wine."""
    return sys.platform == "win32" and hasattr(ctypes.windll.ntdll, "wine_get_version")


needs_pools = pytest.mark.skipif(is_wine(), reason="under Wine, process pools of the standard library hang")
