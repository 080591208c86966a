"""Notes on long work, such as a file, for the browser that requested it, whatever scene it shows by then."""

import threading
import traceback
from collections.abc import Callable

import viser

SHOWN_TIME = 10.0  # [s] for which the result of work is shown


class LongWork:
    """Work in a separate thread, with a notification in the requesting browser."""

    def __init__(self, client: viser.ClientHandle, title: str, failed: str) -> None:
        """title: names the work. failed: first words of the message on a failure."""
        self.failed = failed
        self.words = client.add_notification(title, "…", loading=True)

    def start(self, work: Callable[[], str], done: Callable[[], None]) -> None:
        """Do the work, which returns the words on its end or raises. done: called in any case."""

        def run() -> None:
            try:
                self.end(work(), "green")
            except OSError as error:  # a TimeoutError is one too
                self.end(f"{self.failed}: {error.strerror or error}", "red")
            except (ValueError, RuntimeError) as reason:
                self.end(f"{self.failed}: {reason}", "red")
            except Exception as error:
                traceback.print_exc()
                self.end(f"{self.failed}: {type(error).__name__}: {error}", "red")
            finally:
                done()

        threading.Thread(target=run, name="long work", daemon=True).start()

    def end(self, text: str, color: str) -> None:
        """Show the result for a while."""
        words = self.words
        words.body, words.loading, words.color = text, False, color  # type: ignore[assignment]
        words.auto_close_seconds = SHOWN_TIME
