"""Names the tests that had to be tried again, and fails a run with too many of them."""

import pytest

MAX_RERUNS = 3


def pytest_configure(config: pytest.Config) -> None:
    config.pluginmanager.register(Reruns(config))


class Reruns:
    """The tests tried again in one session. With pytest-xdist the controller decides, which gets the reports of all."""

    def __init__(self, config: pytest.Config) -> None:
        self.config = config
        self.found: list[str] = []  # the name of each, and why its first try failed
        self.decides = not hasattr(config, "workerinput")

    def pytest_runtest_logreport(self, report: pytest.TestReport) -> None:
        if report.outcome == "rerun":  # as pytest-rerunfailures calls it
            crash = getattr(report.longrepr, "reprcrash", None)
            reason = str(crash.message if crash else report.longrepr).partition("\n")[0]
            self.found.append(f"{report.nodeid}: {reason}")

    def pytest_sessionfinish(self, session: pytest.Session) -> None:
        if self.decides and len(self.found) > MAX_RERUNS and session.exitstatus == pytest.ExitCode.OK:
            session.exitstatus = pytest.ExitCode.TESTS_FAILED

    def pytest_terminal_summary(self, terminalreporter: pytest.TerminalReporter) -> None:
        if not self.decides:
            return
        for found in self.found:
            terminalreporter.write_line(f"tried again: {found}")
        if len(self.found) > MAX_RERUNS:
            terminalreporter.write_line(f"failed: {len(self.found)} reruns; allowed: at most {MAX_RERUNS}", red=True)
