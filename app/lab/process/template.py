"""Processes forked from one with all imports of a student's functions: a fork takes a few milliseconds.

The template waits at a socket. A request with three files forks a process that has these as standard input, standard
output and trace; another one reaps a process that has ended, which keeps its number until then. The template ends with
the lab, and its forks notice that (`worker.end_with_parent`) and end too. A process remembers the connection to its
template: a new template does not know the processes of an earlier one. Linux only: elsewhere each process is started.
"""

import contextlib
import gc
import os
import select
import signal
import socket
import struct
import subprocess
import sys
import threading
from collections.abc import Sequence
from typing import IO

FORK, FORK_COMPILER, REAP = range(3)  # requests
REQUEST = struct.Struct("<Bq")  # one of them, and the number of a process to reap
ANSWER = struct.Struct("<q")  # number of a new process, or the exit status of one that was reaped
UNKNOWN = -(2**31)  # exit status of a process that is not the template's
MAX_STARTS = 3  # of a template for one process
ANSWER_LIMIT = 60.0  # [s] until a template answers: a new one imports numpy, and all its processes end with it
FILES = 3  # of a process


class Forked:
    """A forked process, seen from the lab; used like `subprocess.Popen`."""

    def __init__(
        self, template: "Template", connection: socket.socket, pid: int, watched: int, stdin: IO[bytes],
        stdout: IO[bytes],
    ) -> None:  # fmt: skip
        """connection: to the template that forked it. watched: a file that is readable once it has ended."""
        self.template, self.connection, self.pid, self.watched = template, connection, pid, watched
        self.stdin, self.stdout = stdin, stdout
        self.returncode: int | None = None

    @property
    def is_orphan(self) -> bool:
        """True if its template is known to have ended: it then ends too."""
        return self.template.connection is not self.connection

    def has_ended(self, *, block: bool = False) -> bool:
        """True if it has ended. block: wait for the end."""
        if self.returncode is None:
            ended = select.poll()
            ended.register(self.watched, select.POLLIN)
            return bool(ended.poll(None if block else 0))
        return True

    def send_signal(self, number: int) -> None:
        """Send a signal. Raises OSError if that is not possible."""
        if self.returncode is None:
            os.kill(self.pid, number)

    def kill(self) -> None:
        """End it."""
        self.send_signal(signal.SIGKILL)

    def wait(self) -> int:
        """Wait until it has ended, and reap it; returns its exit status."""
        if self.returncode is None:
            self.has_ended(block=True)
            status = self.template.reap(self.connection, self.pid)
            self.returncode = -signal.SIGKILL if status is None else status
            os.close(self.watched)
        return self.returncode


class Template:
    """The template of a lab, from the lab's side; started at the first fork, and again after its end."""

    def __init__(self) -> None:
        self.process: subprocess.Popen[bytes] | None = None
        self.connection: socket.socket | None = None
        self.lock = threading.Lock()  # a request and its answer

    def fork(self, command: Sequence[str], environment: dict[str, str], trace: int, *, compiles: bool) -> Forked:
        """Fork a process. command, environment: that start the template. trace: a file of the new process.

        Raises OSError if there can be no more processes.
        """
        theirs_in, ours_in = os.pipe()
        ours_out, theirs_out = os.pipe()
        stdin, stdout = os.fdopen(ours_in, "wb"), os.fdopen(ours_out, "rb")
        request, files = FORK_COMPILER if compiles else FORK, (theirs_in, theirs_out, trace)
        try:
            with self.lock:  # another thread waits, and finds the template that this one has started
                for _ in range(MAX_STARTS):
                    with contextlib.suppress(ConnectionError):
                        pid = self.ask(request, 0, files)
                        break
                    self.start(command, environment)
                else:
                    pid = self.ask(request, 0, files)
                return Forked(self, self.connected, pid, self.watch(pid), stdin, stdout)
        except OSError:
            stdin.close()
            stdout.close()
            raise
        finally:
            os.close(theirs_in)
            os.close(theirs_out)

    def reap(self, connection: socket.socket, pid: int) -> int | None:
        """Exit status of a process of the template at a connection; None if that template has ended."""
        with self.lock, contextlib.suppress(ConnectionError, TimeoutError):
            if connection is self.connection:
                status = self.ask(REAP, pid)
                return None if status == UNKNOWN else status
        return None

    @property
    def connected(self) -> socket.socket:
        """The connection to a template that has answered."""
        assert self.connection is not None
        return self.connection

    def watch(self, pid: int) -> int:
        """A file that is readable once a process has ended. Without one, ends the process and raises OSError."""
        try:
            return os.pidfd_open(pid)
        except OSError:
            os.kill(pid, signal.SIGKILL)
            self.ask(REAP, pid)
            raise

    def start(self, command: Sequence[str], environment: dict[str, str]) -> None:
        """Replace a template that has ended; with the lock held. Raises OSError."""
        if self.process is not None:
            self.process.kill()
            self.process.wait()
        ours, theirs = socket.socketpair(socket.AF_UNIX, socket.SOCK_SEQPACKET)
        ours.settimeout(ANSWER_LIMIT)
        with theirs:
            self.process = subprocess.Popen(
                command,
                stdin=theirs.fileno(),
                stdout=subprocess.DEVNULL,
                stderr=subprocess.DEVNULL,
                env=environment,
                process_group=0,  # Ctrl-C in the terminal is the lab's to handle
            )
        self.connection = ours

    def disconnect(self) -> None:
        """Disconnect from a template that has ended or is given up."""
        self.connected.close()
        self.connection = None

    def ask(self, request: int, pid: int, files: Sequence[int] = ()) -> int:
        """The answer to a request; with the lock held.

        Raises ConnectionError if no template runs, TimeoutError if it does not answer, another OSError of a fork.
        """
        if self.connection is None:
            raise ConnectionError("the fork server has not started yet")
        try:
            socket.send_fds(self.connection, [REQUEST.pack(request, pid)], files)
            answer = self.connection.recv(ANSWER.size)
        except TimeoutError:
            self.disconnect()
            raise TimeoutError(f"the fork server did not answer within {ANSWER_LIMIT:g} s") from None
        except OSError:
            answer = b""
        if not answer:
            self.disconnect()
            raise ConnectionError("the fork server has ended")
        number = ANSWER.unpack(answer)[0]
        if request != REAP and number <= 0:
            raise OSError(-number, os.strerror(-number))
        return number


def can_fork() -> bool:
    """True if processes can be forked, and watched while they are another's children."""
    if sys.platform != "linux":
        return False
    try:
        os.close(os.pidfd_open(os.getpid()))
    except OSError:  # an old kernel, or a container that does not allow it
        return False
    return True


def fork_on_request() -> tuple[int, bool, int]:
    """Serve the requests that come through standard input. Returns in each forked process: (trace, compiles, template).

    template: the number of this process, which has ended if it is no longer the parent. Ends when the lab has ended.
    """
    own = os.getpid()
    connection = socket.socket(fileno=os.dup(0))
    gc.collect()
    gc.freeze()  # so that a collection in a fork copies no page
    while True:
        message, files, _, _ = socket.recv_fds(connection, REQUEST.size, FILES)
        if not message:
            sys.exit()
        request, pid = REQUEST.unpack(message)
        if request == REAP:
            try:
                answer = os.waitstatus_to_exitcode(os.waitpid(pid, 0)[1])
            except ChildProcessError:
                answer = UNKNOWN
        else:
            try:
                answer = os.fork()
            except OSError as error:
                answer = -(error.errno or 1)
            if answer == 0:
                connection.close()
                os.setsid()
                os.dup2(files[0], 0)
                os.dup2(files[1], 1)
                os.close(files[0])
                os.close(files[1])
                return files[2], request == FORK_COMPILER, own
            for file in files:
                os.close(file)
        connection.send(ANSWER.pack(answer))
