"""Text files in which the same table stands in many forms: what is not ambiguous is read."""

from pathlib import Path

import numpy as np
import pytest

from sigmahat.recording.log import LogError
from sigmahat.recording.readers.formats import open_log

NAMES = ("time", "motor", "link", "torque")
VALUES = [[0.001 * k, np.sin(k), np.cos(k), 0.1 * k] for k in range(30)]


def rows(delimiter: str = ",", decimal: str = ".", end: str = "\n") -> str:
    lines = (delimiter.join(f"{x:.6f}" for x in row) for row in VALUES)
    return "".join(f"{line.replace('.', decimal)}{end}" for line in lines)


HEAD = ",".join(NAMES) + "\n"
FORMS = {
    "plain": HEAD + rows(),
    "an empty line below the names": f"{HEAD}\n{rows()}",
    "comments before the names": f"# Test started at Thu\n# kt = 0.11, N.m/A\n{HEAD}{rows()}",
    "comments of MATLAB": f"% exported, today\n{HEAD}{rows()}",
    "names in a comment": "# " + HEAD + rows(),
    "names in a comment, with spaces": f"# {' '.join(NAMES)}\n{rows(' ')}",
    "aligned with spaces": f"{'  '.join(NAMES)}\n{rows('   ')}",
    "lines of a device": f"Device: X7\nSerial;12\nRate [Hz],1000\n\n{HEAD}{rows()}",
    "the first line of Excel": f"sep=;\n{';'.join(NAMES)}\n{rows(';', ',')}",
    "tabs and decimal commas": f"{chr(9).join(NAMES)}\n{rows(chr(9), ',')}",
    "CR CR LF": HEAD.replace("\n", "\r\r\n") + rows(end="\r\r\n"),
    "a delimiter ends the rows": HEAD + rows(end=",\n"),
    "a delimiter ends the names": HEAD.replace("\n", ",\n") + rows(),
    "delimiters end all lines": HEAD.replace("\n", ",,\n") + rows(end=",,\n"),
    "quotes": ",".join(f'"{name}"' for name in NAMES) + "\n" + rows(),
    "a comment between the rows": f"{HEAD}{rows()}# paused, for, some, reason\n",
    "a column without a name": "," + HEAD + "".join(f"7,{line}\n" for line in rows().split()),
}


@pytest.mark.parametrize("form", FORMS)
def test_every_form_has_the_same_columns(form: str, tmp_path: Path) -> None:
    path = tmp_path / "log.csv"
    path.write_bytes(FORMS[form].encode())
    log = open_log(path)
    for name, values in zip(NAMES, np.transpose(VALUES), strict=True):
        np.testing.assert_allclose(log.read(name), values, atol=1e-6)


def test_a_row_of_units_joins_the_names(tmp_path: Path) -> None:
    (tmp_path / "log.csv").write_text(f"{HEAD}\ns,rad,rad,N.m\n{rows()}")
    log = open_log(tmp_path / "log.csv")
    assert list(log.columns) == ["time [s]", "motor [rad]", "link [rad]", "torque [N.m]"]
    assert [note.in_words for note in log.notes] == ["line 3 has the units of the columns"]


def test_a_name_that_is_there_twice_is_told_apart_and_said(tmp_path: Path) -> None:
    (tmp_path / "log.csv").write_text("Time,motor,Time,link\n" + rows())
    log = open_log(tmp_path / "log.csv")
    assert list(log.columns) == ["Time", "motor", "Time (2)", "link"]
    (note,) = log.notes
    assert note.in_words == "column 'Time' is there again: it is called 'Time (2)' here"


def test_what_was_left_out_is_said_once(tmp_path: Path) -> None:
    (tmp_path / "log.csv").write_text(f"# a\n# b\n{HEAD}{rows()}# c\n{rows()}")
    log = open_log(tmp_path / "log.csv")
    assert len(log.read("time")) == 2 * len(VALUES)
    assert [note.in_words for note in log.notes] == [
        "2 lines of text above the rows left out",
        "1 line of comments between the rows left out",
    ]


@pytest.mark.parametrize(
    ("text", "words"),
    [
        (HEAD + rows() + "1,2,3,4,5\n", "the row '1,2,3,4,5' has 5 values, the other rows 4"),
        (rows(), "line 1 has numbers, expected the names of the columns"),
        (HEAD, "expected rows below the column names, found none"),
        ("# nothing\n# but comments\n", "expected names of columns and rows, found none"),
        ("a,b\n" + rows(), "line 2 has 4 values, line 1 names 2 columns"),
    ],
)
def test_a_refusal_names_the_line_and_the_true_reason(
    text: str, words: str, tmp_path: Path
) -> None:
    (tmp_path / "log.csv").write_text(text)
    with pytest.raises(LogError, match=words):
        open_log(tmp_path / "log.csv")
