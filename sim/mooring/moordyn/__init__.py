"""MoorDyn's input files: versions 1 and 2 are read, version 2 is written.

A section begins with a line of dashes and its name, then two lines of column names and units; OPTIONS has none. What a
System cannot hold is refused by name, all of it in one message. What changes no force is left out with one warning.
"""

from sim.mooring.moordyn.change import changed_moordyn
from sim.mooring.moordyn.read import read_moordyn
from sim.mooring.moordyn.write import write_moordyn

__all__ = ["changed_moordyn", "read_moordyn", "write_moordyn"]
