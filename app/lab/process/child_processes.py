"""Processes that end together on Windows, which has no groups of processes: job objects.

A process in a job, and all that it starts, is killed when the job is closed. The program that made the job holds it
open, so that all end with that program, however it ends and whatever they do.
"""

import contextlib
import subprocess
import sys
import weakref
from typing import Any

if sys.platform == "win32":
    import ctypes
    from ctypes import wintypes

    KILL_ON_CLOSE, BELOW_NORMAL, LIMIT_PRIORITY, LIMITS = 0x2000, 0x4000, 0x20, 9  # of winnt.h and winbase.h
    SET_QUOTA_AND_TERMINATE = 0x0101

    class Limits(ctypes.Structure):
        """JOBOBJECT_EXTENDED_LIMIT_INFORMATION."""

        _fields_ = (
            ("process_time", ctypes.c_int64), ("job_time", ctypes.c_int64), ("flags", wintypes.DWORD),
            ("least_set", ctypes.c_size_t), ("most_set", ctypes.c_size_t), ("processes", wintypes.DWORD),
            ("affinity", ctypes.c_size_t), ("priority", wintypes.DWORD), ("scheduling", wintypes.DWORD),
            ("transfers", ctypes.c_uint64 * 6), ("process_memory", ctypes.c_size_t), ("job_memory", ctypes.c_size_t),
            ("peak_process_memory", ctypes.c_size_t), ("peak_job_memory", ctypes.c_size_t),
        )  # fmt: skip

    kernel32 = ctypes.WinDLL("kernel32", use_last_error=True)
    for name, result in (("CreateJobObjectW", wintypes.HANDLE), ("OpenProcess", wintypes.HANDLE)):
        getattr(kernel32, name).restype = result
    for name in ("CloseHandle", "TerminateJobObject"):
        getattr(kernel32, name).argtypes = (wintypes.HANDLE, wintypes.UINT)[: 1 + (name == "TerminateJobObject")]
    kernel32.SetInformationJobObject.argtypes = (wintypes.HANDLE, ctypes.c_int, ctypes.c_void_p, wintypes.DWORD)
    kernel32.AssignProcessToJobObject.argtypes = (wintypes.HANDLE, wintypes.HANDLE)

    def make_job(pid: int, background: bool) -> int | None:
        """The handle of a new job with this process in it; None if the system refuses."""
        job = kernel32.CreateJobObjectW(None, None)
        process = kernel32.OpenProcess(SET_QUOTA_AND_TERMINATE, False, pid)
        limits = Limits(flags=KILL_ON_CLOSE)
        if background:
            limits.flags, limits.priority = KILL_ON_CLOSE | LIMIT_PRIORITY, BELOW_NORMAL
        is_set = job and kernel32.SetInformationJobObject(job, LIMITS, ctypes.byref(limits), ctypes.sizeof(limits))
        is_made = bool(is_set and process and kernel32.AssignProcessToJobObject(job, process))
        for handle in (process, None if is_made else job):
            if handle:
                kernel32.CloseHandle(handle)
        return job if is_made else None

    def close_job(job: int) -> None:
        """Kill all processes of a job."""
        kernel32.TerminateJobObject(job, 1)
        kernel32.CloseHandle(job)

    jobs: "weakref.WeakKeyDictionary[subprocess.Popen[Any], int]" = weakref.WeakKeyDictionary()

    def end_with_this_program(process: "subprocess.Popen[Any]", *, background: bool = False) -> None:
        """Let a process, and all that it starts, end with this program. background: at a low priority."""
        job = make_job(process.pid, background)
        if job is not None:
            jobs[process] = job

    def kill_with_children(process: "subprocess.Popen[Any]") -> None:
        """Kill a process and its descendants. Raises OSError if that is impossible."""
        job = jobs.pop(process, None)
        if job is not None:
            close_job(job)
        with contextlib.suppress(PermissionError):  # it has ended
            process.kill()

else:

    def end_with_this_program(process: "subprocess.Popen[Any]", *, background: bool = False) -> None:
        """Do nothing: elsewhere a process sees that it is an orphan."""

    def kill_with_children(process: "subprocess.Popen[Any]") -> None:
        """Kill a process. Raises OSError if that is impossible."""
        process.kill()
