"""`springtide --version`."""

import platform
from importlib.metadata import version

import pytest

from app.__main__ import main


def test_the_version_names_what_a_report_needs(capsys: pytest.CaptureFixture[str]) -> None:
    with pytest.raises(SystemExit) as ended:
        main(["--version"])
    assert ended.value.code == 0
    said = capsys.readouterr().out
    assert said.count("\n") == 1
    for words in (platform.system(), f"Python {platform.python_version()}", f"viser {version('viser')}"):
        assert words in said
