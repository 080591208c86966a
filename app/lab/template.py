"""Processes forked from one that has imported what a student's functions need: a fork takes a few milliseconds.

The template waits at a socket. A request with three files forks a process that has these as standard input, standard
output and trace; another one reaps a process that has ended, which keeps its number until then. The template ends with
the lab, and what it has forked notices that (`worker.end_with_parent`). Linux only: elsewhere each process is started.
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
START_LIMIT = 10.0  # [s] until a new template answers, which imports numpy
FILES = 3  # of a process


class Forked:
    """A forked process, as the lab sees it; used as `subprocess.Popen`."""

    def __init__(self, template: "Template", pid: int, stdin: IO[bytes], stdout: IO[bytes]) -> None:
        """Raises OSError where the process cannot be watched."""
        self.template, self.pid, self.stdin, self.stdout = template, pid, stdin, stdout
        self.returncode: int | None = None
        self.watched = os.pidfd_open(pid)

    def has_ended(self, *, block: bool = False) -> bool:
        """Return whether it has ended. block: wait until it has."""
        if self.returncode is None:
            ended = select.poll()
            ended.register(self.watched, select.POLLIN)
            return bool(ended.poll(None if block else 0))
        return True

    def send_signal(self, number: int) -> None:
        """Send a signal. Raises OSError where that is not possible."""
        if self.returncode is None:
            os.kill(self.pid, number)

    def kill(self) -> None:
        """End it."""
        self.send_signal(signal.SIGKILL)

    def wait(self) -> int:
        """Wait until it has ended, and reap it; returns its exit status."""
        if self.returncode is None:
            self.has_ended(block=True)
            try:
                self.returncode = self.template.ask(REAP, self.pid)
            except OSError:  # the template has ended, and the process with it
                self.returncode = -signal.SIGKILL
            os.close(self.watched)
        return self.returncode


class Template:
    """The template of a lab, from the lab's side; started at the first fork, and again where it has ended."""

    def __init__(self) -> None:
        self.process: subprocess.Popen[bytes] | None = None
        self.connection: socket.socket | None = None
        self.lock = threading.Lock()  # a request and its answer

    def fork(self, command: Sequence[str], environment: dict[str, str], trace: int, *, compiles: bool) -> Forked:
        """Fork a process. command, environment: that start the template. trace: a file of the new process.

        Raises OSError where there can be no more processes.
        """
        theirs_in, ours_in = os.pipe()
        ours_out, theirs_out = os.pipe()
        stdin, stdout = os.fdopen(ours_in, "wb"), os.fdopen(ours_out, "rb")
        request = FORK_COMPILER if compiles else FORK
        try:
            with contextlib.suppress(ConnectionError):
                return Forked(self, self.ask(request, 0, (theirs_in, theirs_out, trace)), stdin, stdout)
            self.start(command, environment)
            return Forked(self, self.ask(request, 0, (theirs_in, theirs_out, trace)), stdin, stdout)
        except OSError:
            stdin.close()
            stdout.close()
            raise
        finally:
            os.close(theirs_in)
            os.close(theirs_out)

    def start(self, command: Sequence[str], environment: dict[str, str]) -> None:
        """Start a template in place of one that has ended. Raises OSError."""
        with self.lock:
            if self.process is not None:
                self.process.kill()
                self.process.wait()
            ours, theirs = socket.socketpair(socket.AF_UNIX, socket.SOCK_SEQPACKET)
            ours.settimeout(START_LIMIT)
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

    def ask(self, request: int, pid: int, files: Sequence[int] = ()) -> int:
        """The answer to a request. Raises ConnectionError where no template runs, another OSError of a fork."""
        with self.lock:
            if self.connection is None:
                raise ConnectionError
            try:
                socket.send_fds(self.connection, [REQUEST.pack(request, pid)], files)
                answer = self.connection.recv(ANSWER.size)
            except OSError:
                answer = b""
            if not answer:
                self.connection.close()
                self.connection = None
                raise ConnectionError
        found = ANSWER.unpack(answer)[0]
        if request != REAP and found <= 0:
            raise OSError(-found, os.strerror(-found))
        return found


def can_fork() -> bool:
    """True where processes can be forked, and watched while they are another's children."""
    if sys.platform != "linux":
        return False
    try:
        os.close(os.pidfd_open(os.getpid()))
    except OSError:  # an old kernel, or a container that does not allow it
        return False
    return True


def fork_on_request() -> tuple[int, bool]:
    """Serve the requests that come through standard input. Returns in each forked process: (trace, compiles).

    Ends the template when the lab has ended.
    """
    connection = socket.socket(fileno=os.dup(0))
    gc.collect()
    gc.freeze()  # so that a collection in a fork copies no page
    while True:
        message, files, _, _ = socket.recv_fds(connection, REQUEST.size, FILES)
        if not message:
            sys.exit()
        request, pid = REQUEST.unpack(message)
        if request == REAP:
            answer = os.waitstatus_to_exitcode(os.waitpid(pid, 0)[1])
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
                return files[2], request == FORK_COMPILER
            for file in files:
                os.close(file)
        connection.send(ANSWER.pack(answer))
