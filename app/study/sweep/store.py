"""The finished cases of a sweep, stored one by one beside its output until the output is written.

One SQLite file: it holds a case completely or not at all, whatever ends the program, and two sweeps cannot write to one
file at a time.
"""

import json
import sqlite3
from pathlib import Path
from typing import Any

from app.study.sweep.case import ENDS, Outcome


class Store:
    """The finished cases of one sweep. outcomes: case number -> outcome, as read when the store was opened."""

    def __init__(self, path: Path, identity: dict[str, Any]) -> None:
        """Open or make the store of the sweep with this identity: its spec and its program.

        Raises ValueError if the file belongs to another sweep, is no store, or another program writes to it; OSError
        where it cannot be read or written.
        """
        self.path = path
        try:
            self.connection = sqlite3.connect(path, timeout=0.5, isolation_level=None)
        except sqlite3.Error as error:
            raise OSError(f"{path}: {error}") from None
        try:
            check_same_sweep(path, self.lock(identity), identity)
            self.outcomes = self.read()
        except BaseException:
            self.close()
            raise

    def lock(self, identity: dict[str, Any]) -> Any:
        """Take the file for this program alone; returns the identity of the sweep that it belongs to."""
        try:
            self.connection.execute("PRAGMA locking_mode = EXCLUSIVE")
            self.connection.execute("BEGIN EXCLUSIVE")
            self.connection.execute("CREATE TABLE IF NOT EXISTS about (content TEXT NOT NULL)")
            self.connection.execute(
                "CREATE TABLE IF NOT EXISTS cases (number INTEGER PRIMARY KEY, outcome TEXT NOT NULL)"
            )
            if columns_of(self.connection, "about") != ["content"] or columns_of(self.connection, "cases") != [
                "number",
                "outcome",
            ]:
                raise no_store(self.path, "it has other columns")
            row = self.connection.execute("SELECT content FROM about").fetchone()
            if row is None:
                self.connection.execute("INSERT INTO about VALUES (?)", (json.dumps(identity),))
            self.connection.execute("COMMIT")
            return json.loads(json.dumps(identity) if row is None else row[0])
        except sqlite3.OperationalError as error:
            if "locked" in str(error):
                raise ValueError(f"--out: another sweep is writing to {self.path}") from None
            raise OSError(f"{self.path}: {error}") from None
        except (sqlite3.DatabaseError, json.JSONDecodeError, TypeError) as error:
            raise no_store(self.path, error) from None

    def read(self) -> dict[int, Outcome]:
        """The stored outcomes by the number of their case."""
        try:
            rows = self.connection.execute("SELECT number, outcome FROM cases ORDER BY number").fetchall()
            return {number: outcome_of(json.loads(outcome)) for number, outcome in rows}
        except sqlite3.OperationalError as error:
            raise OSError(f"{self.path}: {error}") from None
        except (sqlite3.DatabaseError, ValueError, TypeError) as error:
            raise no_store(self.path, error) from None

    def add(self, number: int, outcome: Outcome) -> None:
        """Store one case. Raises OSError if it cannot be stored."""
        try:
            text = json.dumps(outcome._asdict())
            self.connection.execute("INSERT OR REPLACE INTO cases VALUES (?, ?)", (number, text))
        except sqlite3.Error as error:
            raise OSError(f"{self.path}: {error}; the cases finished before are kept") from None

    def close(self) -> None:
        """Release the file."""
        self.connection.close()

    def remove(self) -> None:
        """Close and delete the file."""
        self.close()
        remove(self.path)


def columns_of(connection: sqlite3.Connection, table: str) -> list[str]:
    """The names of a table's columns."""
    return [row[1] for row in connection.execute(f"PRAGMA table_info({table})")]


def outcome_of(content: Any) -> Outcome:
    """The outcome that was stored as JSON. Raises ValueError or TypeError if it is no outcome."""
    outcome = Outcome(**content)
    sound = outcome.end in ENDS and isinstance(outcome.message, str)
    sound = sound and all(isinstance(number, float) for number in (outcome.diverged_at, outcome.run_time))
    sound = sound and isinstance(outcome.measures, dict) and isinstance(outcome.labels, dict)
    if not sound or outcome.measures.keys() != outcome.labels.keys():
        raise ValueError("an outcome of another form")
    for values, label in zip(outcome.measures.values(), outcome.labels.values(), strict=True):
        if not isinstance(values, list) or not all(isinstance(value, int | float) for value in values):
            raise ValueError("measures of another form")
        if not isinstance(label, list) or [type(word) for word in label] != [str, str]:
            raise ValueError("labels of another form")
    return outcome


def no_store(path: Path, reason: object) -> ValueError:
    """The error for a file that is no store."""
    return ValueError(f"--out: {path} is not an unfinished sweep ({reason}); --fresh replaces it")


def remove(path: Path) -> None:
    """Delete a store, if there is one."""
    for name in (path.name, f"{path.name}-journal"):
        path.with_name(name).unlink(missing_ok=True)


def check_same_sweep(path: Path, old: Any, new: dict[str, Any]) -> None:
    """Raises ValueError if the file at `path` belongs to another sweep, and names the differences."""
    new = json.loads(json.dumps(new))
    if old == new:
        return
    if not isinstance(old, dict) or not isinstance(old.get("spec"), dict):
        raise no_store(path, "it names no spec")
    if old["spec"] == new["spec"]:
        words = f"was begun by {old.get('program')}, this is {new['program']}"
    else:
        names = [name for name in new["spec"] if old["spec"].get(name) != new["spec"][name]]
        words = f"belongs to another spec, with other {', '.join(names)}"
    raise ValueError(f"--out: {path} {words}; --fresh starts over")
