"""Valid messages with their values, and invalid messages."""

import math

import pytest
from hypothesis import given
from hypothesis import strategies as st

from sigmahat.live.messages import LONGEST, Decoder

WANTED = ("t", "arm/motor[1]", "/torque")


def test_json_as_plotjuggler_names_it() -> None:
    message = (
        b'{"t": 1700000000000000001, "arm": {"motor": [1, -2.5], "x": "text"}, "torque": null}'
    )
    found = Decoder(WANTED).columns(message)
    assert found is not None
    assert found["t"] == 1_700_000_000_000_000_001
    assert found["arm/motor[1]"] == -2.5
    assert math.isnan(found["/torque"])
    assert set(found) == set(WANTED)


def test_csv_with_a_line_of_names_or_without() -> None:
    named = Decoder(WANTED)
    assert named.columns(b't, x, "arm/motor[1]", torque\n') is None
    assert named.columns(b"1,abc,2.5e-1,\r\n") == pytest.approx(
        {"t": 1, "arm/motor[1]": 0.25, "/torque": math.nan}, nan_ok=True
    )
    given_ = Decoder(WANTED, ["torque", "t", "arm/motor[1]"])
    assert given_.columns(b"1,2,3\n") == {"/torque": 1, "t": 2, "arm/motor[1]": 3}


@pytest.mark.parametrize(
    ("message", "expected"),
    [
        (b"", "CSV that ends with a line feed, got b''"),
        (b"1,2,3", "ends with a line feed"),
        (b"1,2\n", r"expected 3 cells, got b'1,2\\n'"),
        (b"1,abc,3\n", "arm/motor.1.: expected a number, got 'abc'"),
        (b"\xff\xfe,2,3\n", "expected text in UTF-8"),
        (b'{"t": 1', "expected a whole JSON object"),
        (b'{"x": 1}', "expected one of t, arm/motor.1., torque"),
        (b'{"t": 12345678901234567890}', "t: expected a number, got '12345678901234567890'"),
        (b'{"t": true}', "t: expected a number, got 'True'"),
        (b'{"t": [1]}', "expected one of"),
        (b'{"t": ' + b"9" * 5000 + b"}", "expected a whole JSON object"),
        (b'{"t":' + b"[" * 60_000, "expected a whole JSON object"),
        (b'{"":' * 500 + b"1" + b"}" * 500, "at most 8 levels"),
        (b" " * (LONGEST + 1), f"expected at most {LONGEST} bytes, got {LONGEST + 1}"),
    ],
)
def test_what_is_no_message_is_said(message: bytes, expected: str) -> None:
    with pytest.raises(ValueError, match=expected):
        Decoder(WANTED, WANTED).columns(message)


def test_values_without_names() -> None:
    expected = "expected the names of the columns first, over UDP by --columns, got b'1,2"
    with pytest.raises(ValueError, match=expected):
        Decoder(WANTED).columns(b"1,2,3\n")


def test_a_damaged_line_of_names_does_not_rename_the_columns() -> None:
    decoder = Decoder(WANTED)
    assert decoder.columns(b"t,arm/motor[1],torque\n") is None
    with pytest.raises(ValueError, match="expected 3 cells, got b't"):
        decoder.columns(b"t\n")
    assert decoder.columns(b"torque,t,x,arm/motor[1]\n") is None
    assert decoder.columns(b"1,2,3,4\n") == {"/torque": 1, "t": 2, "arm/motor[1]": 4}


def test_a_datagram_does_not_rename_the_columns_of_other_senders() -> None:
    decoder = Decoder(WANTED, WANTED)
    with pytest.raises(ValueError, match=r"t: expected a number, got 'torque'"):
        decoder.values(b"torque,x,t\n")
    with pytest.raises(ValueError, match=r"expected 3 cells, got b't,x"):
        decoder.values(b"t,x\n")
    assert decoder.values(b"1,2,3\n") == {"t": 1, "arm/motor[1]": 2, "/torque": 3}


@given(st.binary(max_size=200))
def test_any_bytes_are_numbers_or_an_error(message: bytes) -> None:
    for begin in (b"", b"{", b'{"t":'):
        try:
            found = Decoder(WANTED, WANTED).columns(begin + message)
        except ValueError:
            continue
        assert found is None or all(isinstance(each, (int, float)) for each in found.values())
