"""Fails a run of the tests in which too many had to be tried again."""

import pytest

MAX_RERUNS = 3


def pytest_configure(config: pytest.Config) -> None:
    config.pluginmanager.register(Reruns(config))


class Reruns:
    """The counter of one session. With pytest-xdist it counts in the controller, which gets the reports of all."""

    def __init__(self, config: pytest.Config) -> None:
        self.config, self.count = config, 0
        self.decides = not hasattr(config, "workerinput")

    def pytest_runtest_logreport(self, report: pytest.TestReport) -> None:
        self.count += report.outcome == "rerun"  # as pytest-rerunfailures calls it

    def pytest_sessionfinish(self, session: pytest.Session) -> None:
        if self.decides and self.count > MAX_RERUNS and session.exitstatus == pytest.ExitCode.OK:
            session.exitstatus = pytest.ExitCode.TESTS_FAILED

    def pytest_terminal_summary(self, terminalreporter: pytest.TerminalReporter) -> None:
        if self.decides and self.count > MAX_RERUNS:
            terminalreporter.write_line(f"failed: {self.count} reruns; allowed: at most {MAX_RERUNS}", red=True)
