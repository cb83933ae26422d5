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
    "the time of a terminal before each line": "".join(
        f"12:03:44.{k:03} -> {line}\n" for k, line in enumerate((HEAD + rows()).split())
    ),
    "dates of a terminal before each line": "".join(
        f"[2026-03-12 12:03:44] {line}\n" for line in (HEAD + rows()).split()
    ),
    "statistics below the rows": f"{HEAD}{rows()}\nMean,1,2,3\nStd Dev,1,2,3\nEnd of file, Kim\n",
    "a mark at the end": f"{HEAD}{rows()}EOF\n",
    "a measurement file of LabVIEW": (
        "LabVIEW Measurement\t\nSeparator\tTab\n***End_of_Header***\t\n\t\n"
        "Channels\t3\t\t\t\nSamples\t30\t30\t30\t\nDate\t2026/03/12\t2026/03/12\t2026/03/12\t\n"
        f"***End_of_Header***\t\t\t\t\n{chr(9).join(NAMES)}\tComment\n{rows(chr(9), ',')}"
    ),
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


JAPANESE = ("時間", "モータ角度", "リンク角度", "トルク")
ENCODED = {
    "cp932": JAPANESE,
    "gb18030": ("时间", "电机位置", "连杆位置", "电机电流"),
    "cp949": ("시간", "모터각도", "링크각도", "토크"),
    "windows-1251": ("Время", "Положение двигателя", "Положение звена", "Момент"),
    "windows-1252": ("Zeit", "Größe [°]", "Länge µ", "Nachläufe"),
}


@pytest.mark.parametrize("encoding", ENCODED)
def test_what_spreadsheets_write_is_decoded(encoding: str, tmp_path: Path) -> None:
    names = ENCODED[encoding]
    text = ",".join(names) + "\n" + rows()
    (tmp_path / "log.csv").write_bytes(text.encode(encoding))
    log = open_log(tmp_path / "log.csv")
    assert list(log.columns) == list(names)
    np.testing.assert_allclose(log.read(names[1]), np.transpose(VALUES)[1], atol=1e-6)
    assert [note.in_words for note in log.notes] == [f"read as {encoding}: the file is not UTF-8"]


def test_a_name_may_begin_with_a_digit(tmp_path: Path) -> None:
    names = ["Time [ms]", "0x6064:00 Position actual value", "1st torque", "0x6041:00 Statusword"]
    (tmp_path / "log.csv").write_text(",".join(names) + "\n" + rows())
    assert list(open_log(tmp_path / "log.csv").columns) == names


THOUSANDS = {
    "German": '"t";"x"\n' + "".join(f'"{k}";"-0,5"\n' for k in range(250)) + '"1.250";"-1.234,5"\n',
    "English": "t;x\n" + "".join(f"{k};-0.5\n" for k in range(250)) + "1,250;-1,234.5\n",
    "English, in quotes": "t,x\n"
    + "".join(f"{k},-0.5\n" for k in range(250))
    + '"1,250","-1,234.5"\n',
}


@pytest.mark.parametrize("form", THOUSANDS)
def test_separators_between_thousands(form: str, tmp_path: Path) -> None:
    (tmp_path / "log.csv").write_text(THOUSANDS[form])
    log = open_log(tmp_path / "log.csv")
    assert (log.read("t")[-1], log.read("x")[-1]) == (1250, -1234.5)
    assert any("separators of thousands" in note.in_words for note in log.notes)


def test_dates_have_no_thousands(tmp_path: Path) -> None:
    lines = "".join(f"12.03.2026 14:03:{k:02};{k},5;0,{k}\n" for k in range(30))
    (tmp_path / "log.csv").write_text("t;x;y\n" + lines)
    assert open_log(tmp_path / "log.csv").read("x")[2] == 2.5


def test_a_recording_that_was_appended(tmp_path: Path) -> None:
    (tmp_path / "log.csv").write_text(HEAD + rows() + HEAD + rows())
    log = open_log(tmp_path / "log.csv")
    assert log.samples("time") == 2 * len(VALUES)
    (note,) = log.notes
    assert note.in_words.startswith("line 32 has the names of the columns again")


def test_lines_of_json(tmp_path: Path) -> None:
    lines = "".join(
        f'{{"t": {t}, "motor": {{"pos": {a}, "torque": {b}}}, "link": [{c}, 0]}}\n'
        for t, a, b, c in VALUES
    )
    (tmp_path / "log.jsonl").write_text(lines)
    log = open_log(tmp_path / "log.jsonl")
    assert list(log.columns) == ["t", "motor.pos", "motor.torque", "link[0]", "link[1]"]
    np.testing.assert_allclose(log.read("motor.torque"), np.transpose(VALUES)[2])


def test_a_document_of_json_is_refused_with_the_reason(tmp_path: Path) -> None:
    (tmp_path / "log.json").write_text('[\n {"t": 0,\n "x": 1},\n {"t": 1, "x": 2}]\n')
    with pytest.raises(LogError, match="expected one JSON object in each line"):
        open_log(tmp_path / "log.json")


def test_lines_below_the_rows_are_said(tmp_path: Path) -> None:
    (tmp_path / "log.csv").write_text(f"{HEAD}{rows()}\nMean,1,2,3\n")
    notes = [note.in_words for note in open_log(tmp_path / "log.csv").notes]
    assert notes == ["2 lines below the rows, from line 32 on, left out: no rows"]


def test_a_row_that_was_cut_off_is_no_footer(tmp_path: Path) -> None:
    (tmp_path / "log.csv").write_text(f"{HEAD}{rows()}0.03,0.1")
    notes = [note.in_words for note in open_log(tmp_path / "log.csv").notes]
    assert notes == ["a row with 2 of 4 values was left out: the file may have been cut off"]


@pytest.mark.parametrize("text", ["-", "#N/A", "NULL", "1.#QNAN", "#DIV/0!", "None"])
def test_a_text_in_place_of_a_number_is_a_missing_sample(text: str, tmp_path: Path) -> None:
    (tmp_path / "log.csv").write_text(f"{HEAD}{rows()}0.03,{text},1,2\n")
    motor = open_log(tmp_path / "log.csv").read("motor")
    assert len(motor) == 31
    assert np.flatnonzero(np.isnan(motor)).tolist() == [30]


@pytest.mark.parametrize("cell", ['"[0.1, 0.0]"', "[-0.1 0.]"])
def test_lists_in_cells_are_named(cell: str, tmp_path: Path) -> None:
    lines = "".join(f"{k},{0.01 * k},{cell},{cell},{cell}\n" for k in range(9))
    (tmp_path / "log.csv").write_text(f",{HEAD}{lines}")
    with pytest.raises(LogError, match=r"line 2 has a list in a cell \('\[-?0.1"):
        open_log(tmp_path / "log.csv")
