"""Tables of text files: rows of words, and columns with names, units, conventions and missing values."""

from sim.tables.columns import Column, ColumnTable, Kind, Meaning, factor_of, read_columns, read_table
from sim.tables.numbers import is_value, number_of, values_of
from sim.tables.rows import Row, line_error, split_rows
from sim.tables.text import read_text
from sim.tables.times import NAMES as TIME_NAMES
from sim.units import measure_of

__all__ = [
    "TIME_NAMES",
    "Column",
    "ColumnTable",
    "Kind",
    "Meaning",
    "Row",
    "factor_of",
    "is_value",
    "line_error",
    "measure_of",
    "number_of",
    "read_columns",
    "read_table",
    "read_text",
    "split_rows",
    "values_of",
]
