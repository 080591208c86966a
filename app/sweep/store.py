"""What is finished of a sweep, kept case by case beside its output until that is written.

One SQLite file: a case is in it whole or not at all, whatever ends the program, and two sweeps cannot write to one.
"""

import json
import sqlite3
from pathlib import Path
from typing import Any

from app.sweep.case import Outcome


class Store:
    """The finished cases of one sweep."""

    def __init__(self, path: Path, about: dict[str, Any]) -> None:
        """Open or begin; about: spec and program. Raises ValueError where another sweep is in it or writes to it."""
        self.path = path
        try:
            self.base = sqlite3.connect(path, timeout=0.5, isolation_level=None)
        except sqlite3.Error as error:
            raise OSError(f"{path}: {error}") from None
        try:
            refuse_other(path, self.begin(about), about)
        except BaseException:
            self.close()
            raise

    def begin(self, about: dict[str, Any]) -> dict[str, Any]:
        """Take the file for this program alone; returns what it is about."""
        try:
            self.base.execute("PRAGMA locking_mode = EXCLUSIVE")
            self.base.execute("BEGIN EXCLUSIVE")
            self.base.execute("CREATE TABLE IF NOT EXISTS about (content TEXT NOT NULL)")
            self.base.execute("CREATE TABLE IF NOT EXISTS cases (number INTEGER PRIMARY KEY, outcome TEXT NOT NULL)")
            row = self.base.execute("SELECT content FROM about").fetchone()
            if row is None:
                self.base.execute("INSERT INTO about VALUES (?)", (json.dumps(about),))
            self.base.execute("COMMIT")
        except sqlite3.OperationalError as error:
            if "locked" in str(error):
                raise ValueError(f"--out: another sweep is writing to {self.path}") from None
            raise OSError(f"{self.path}: {error}") from None
        except sqlite3.DatabaseError as error:
            raise ValueError(f"--out: {self.path} is not the start of a sweep ({error}); --fresh replaces it") from None
        return json.loads(json.dumps(about) if row is None else row[0])

    def cases(self) -> dict[int, Outcome]:
        """The finished cases by number."""
        rows = self.base.execute("SELECT number, outcome FROM cases ORDER BY number").fetchall()
        return {number: Outcome(**json.loads(outcome)) for number, outcome in rows}

    def add(self, number: int, outcome: Outcome) -> None:
        """Keep one case. Raises OSError where it cannot be kept."""
        try:
            self.base.execute("INSERT OR REPLACE INTO cases VALUES (?, ?)", (number, json.dumps(outcome._asdict())))
        except sqlite3.Error as error:
            raise OSError(f"{self.path}: {error}; what was finished before is kept") from None

    def close(self) -> None:
        self.base.close()

    def remove(self) -> None:
        """Close it and take it away."""
        self.close()
        remove(self.path)


def remove(path: Path) -> None:
    """Take away a store, if there is one."""
    for name in (path.name, f"{path.name}-journal"):
        path.with_name(name).unlink(missing_ok=True)


def refuse_other(path: Path, old: dict[str, Any], new: dict[str, Any]) -> None:
    """Raises ValueError where `path` is of another sweep, saying in what it differs."""
    new = json.loads(json.dumps(new))
    if old == new:
        return
    if old.get("spec") == new["spec"]:
        words = f"was begun by {old.get('program')}, this is {new['program']}"
    else:
        before, now = old.get("spec", {}), new["spec"]
        names = [name for name in now if before.get(name) != now[name]]
        words = f"is of another spec, with other {', '.join(names)}"
    raise ValueError(f"--out: {path} {words}; --fresh starts over")
