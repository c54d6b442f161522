"""Files of records: what is read, and what is said about one that cannot be."""

from __future__ import annotations

import numpy as np
import pytest
from hypothesis import HealthCheck, given, settings
from hypothesis import strategies as st

from dem_cli.core.motion.record_file import read_series
from dem_cli.core.motion.record_text import RecordError

numbers = st.floats(-1e6, 1e6, allow_nan=False)
FORMS = {
    "comma": ("{},{}", "{!r}", ""),
    "blank": ("  {}   {}", "{!r}", "# made by hand\n"),
    "tab": ("{}\t{}", "{!r}", "time\tvalue\n"),
    "semicolon": ("{};{};", "{!r}", "t;a\n\n"),
    "decimal comma": ("{};{}", "{!r}", "Zeit;Wert\n"),
    "decimal comma, blanks": ("{}  {}", "{:.17f}", "Zeit Wert\n"),
    "Fortran": ("  {}  {}", "{:.17E}", "Station 12, Tolmezzo\n"),
    "quoted": ('"{}","{}"', "{!r}", '"time","value"\n'),
    "two header lines": ("{} , {}  # remark", "{!r}", "time, acceleration\ns, g\n"),
}


@pytest.mark.parametrize("form", FORMS)
@settings(suppress_health_check=[HealthCheck.function_scoped_fixture])
@given(rows=st.lists(st.tuples(st.floats(1e-3, 9.0), numbers), min_size=2, max_size=19))
def test_columns_are_read_back(tmp_path, form, rows):
    line, number, header = FORMS[form]
    times = np.cumsum([step for step, _ in rows])
    values = np.array([value for _, value in rows])
    pairs = [[number.format(x) for x in pair] for pair in zip(times.tolist(), values.tolist())]
    if form.startswith("decimal comma"):
        pairs = [[x.replace(".", ",") for x in pair] for pair in pairs]
    if form == "Fortran":
        pairs = [[x.replace("E", "D") for x in pair] for pair in pairs]
    path = tmp_path / "r.csv"
    path.write_text(header + "\n".join(line.format(*pair) for pair in pairs) + "\n")
    found = read_series(path)
    blank = form == "decimal comma, blanks"  # written with so many decimals, not with every digit
    assert found.times.tolist() == (pytest.approx(times.tolist(), rel=1e-14) if blank else times.tolist())
    assert found.values.tolist() == (pytest.approx(values.tolist(), abs=1e-17) if blank else values.tolist())


HEADERS = {
    "UTF-8": "t [s];a [m/s²]\n".encode(),
    "UTF-8 with a mark": "t [s];a [m/s²]\n".encode("utf-8-sig"),
    "Latin-1": "Zeit [s];Beschleunigung [m/s²], Größe\n".encode("latin-1"),
    "Windows": "“Peñón” … 5 €\n".encode("cp1252"),
    "no character of Windows": b"\x81\x8d\n",
}


@pytest.mark.parametrize("header", HEADERS)
def test_a_header_in_any_encoding(tmp_path, header):
    (tmp_path / "r.csv").write_bytes(HEADERS[header] + b"0;1,5\r\n0,1;-2,5\r\n\x1a")
    found = read_series(tmp_path / "r.csv")
    assert (found.times.tolist(), found.values.tolist()) == ([0.0, 0.1], [1.5, -2.5])


@pytest.mark.parametrize("encoding", ["utf-16", "utf-16-le", "utf-16-be"])
def test_unicode_text_of_a_spreadsheet(tmp_path, encoding):
    mark = "" if encoding == "utf-16" else "\ufeff"
    (tmp_path / "r.txt").write_bytes(f"{mark}t\ta\n0\t1\n0.1\t2\n".encode(encoding))
    assert read_series(tmp_path / "r.txt").values.tolist() == [1.0, 2.0]


@settings(suppress_health_check=[HealthCheck.function_scoped_fixture], max_examples=60)
@given(
    values=st.lists(st.floats(-0.999, 0.999).map(lambda x: round(x, 4)), min_size=2, max_size=40),
    per_line=st.integers(1, 9),
)
def test_values_that_go_on_from_line_to_line(tmp_path, values, per_line):
    lines = ["".join(f"{v:9.4f}" for v in values[i : i + per_line]) for i in range(0, len(values), per_line)]
    (tmp_path / "r.txt").write_text("Station 12\n" + "\n".join(lines))
    found = read_series(tmp_path / "r.txt", step=0.02, column="all")
    assert found.values.tolist() == values
    assert found.times.tolist() == (0.02 * np.arange(len(values))).tolist()


def peer(count, step, values, header="ACCELERATION TIME SERIES IN UNITS OF G", sizes="NPTS=  {}, DT=   {} SEC"):
    lines = [" ".join(f"{v:.7E}" for v in values[i : i + 5]) for i in range(0, len(values), 5)]
    return "\n".join(["PEER NGA", "Friuli, 1976", header, sizes.format(count, step), *lines])


@pytest.mark.parametrize("sizes", ["NPTS=  {}, DT=   {} SEC", "NPTS= {} , DT= {}", "   {}    {}    NPTS, DT"])
def test_peer_files(tmp_path, sizes):
    values = np.sin(np.arange(123))
    (tmp_path / "r.AT2").write_text(peer(123, ".0050", values, sizes=sizes))
    found = read_series(tmp_path / "r.AT2")
    assert (found.quantity, found.unit) == ("acceleration", "g")
    assert found.times == pytest.approx(0.005 * np.arange(123))
    assert found.values == pytest.approx(values, abs=1e-7)


@pytest.mark.parametrize(
    ("header", "quantity", "unit"),
    [
        ("VELOCITY TIME SERIES IN UNITS OF CM/S", "velocity", "cm/s"),
        ("DISPLACEMENT TIME HISTORY IN UNITS OF CM", "displacement", "cm"),
        ("nothing said", None, None),
    ],
)
def test_peer_quantities(tmp_path, header, quantity, unit):
    (tmp_path / "r.VT2").write_text(peer(7, "0.01", np.ones(7), header))
    found = read_series(tmp_path / "r.VT2")
    assert (found.quantity, found.unit) == (quantity, unit)


def fortran(value: float, width: int, decimals: int, letter: str) -> str:
    """As Fortran's Ew.d and Fw.d write a number, the first without a 0 before the point."""
    if letter == "F":
        return f"{value:{width}.{decimals}f}"
    mantissa, exponent = f"{value:.{decimals - 1}E}".split("E")
    digits = mantissa.lstrip("-").replace(".", "")
    power = 0 if value == 0.0 else int(exponent) + 1
    return f"{'-' * (value < 0)}.{digits}{letter}{power:+03d}".rjust(width)


@settings(suppress_health_check=[HealthCheck.function_scoped_fixture], max_examples=150)
@given(
    values=st.lists(st.floats(-999.0, 999.0, allow_subnormal=False).filter(lambda x: not 0 < abs(x) < 1e-6),
                    min_size=2, max_size=33),
    per_line=st.integers(1, 8),
    written=st.sampled_from([("E", 13, 7), ("D", 13, 7), ("E", 12, 7), ("F", 8, 3), ("F", 9, 4)]),
)  # fmt: skip
def test_columns_of_a_peer_file_may_touch(tmp_path, values, per_line, written):
    letter, width, decimals = written
    fields = [fortran(v, width, decimals, letter) for v in values]
    if any(len(field) > width for field in fields):
        fields = [fortran(abs(v), width, decimals, letter) for v in values]
    lines = ["".join(fields[i : i + per_line]) for i in range(0, len(fields), per_line)]
    text = "\n".join(["PEER", "Peña", "UNITS OF G", f"NPTS= {len(fields)}, DT= .5D-02 SEC", *lines])
    (tmp_path / "r.AT2").write_bytes(text.encode("latin-1"))
    found = read_series(tmp_path / "r.AT2")
    assert found.values.tolist() == [float(field.replace("D", "E")) for field in fields]
    assert found.times[1] == 0.005


@pytest.mark.parametrize(
    ("line", "values"),
    [
        ("  .1234567E-02  .7654321E-02 -.2345678E-02", [0.001234567, 0.007654321, -0.002345678]),
        (" -.1234567E-02 -.7654321E-02-.2345678E-02", [-0.001234567, -0.007654321, -0.002345678]),  # a blank was lost
        ("1.5-103 -2.5+001-3.5E+00", [1.5e-103, -25.0, -3.5]),
    ],
)
def test_numbers_that_touch_at_a_sign(tmp_path, line, values):
    (tmp_path / "r.AT2").write_text(f"PEER\nNPTS= {len(values)}, DT= 0.01\n{line}\n")
    assert read_series(tmp_path / "r.AT2").values.tolist() == values


def test_values_only(tmp_path):
    (tmp_path / "r.txt").write_text("a\n1\n2\n3\n")
    found = read_series(tmp_path / "r.txt", step=0.5)
    assert found.times.tolist() == [0.0, 0.5, 1.0]
    assert found.values.tolist() == [1.0, 2.0, 3.0]


def test_one_of_several_columns(tmp_path):
    (tmp_path / "r.csv").write_text("0,1,5\n1,2,6\n")
    assert read_series(tmp_path / "r.csv", column=3).values.tolist() == [5.0, 6.0]


EVEN = [f"{0.01 * i:.2f},0.1" for i in range(100)]
BAD = {
    "empty": ("", "no numbers; a record has at least two"),
    "only text": ("# nothing\nhere is\nno record\n", "no numbers"),
    "one row": ("0,1\n", "a single row of numbers"),
    "not a number": ("t,a\n0,1\n0.1,abc\n", ":3: 'abc' is not a number"),
    "header with a number": ("0,abc\n0.1,1\n", ":1: 'abc' is not a number"),
    "empty field": ("0,1\n0.1,\n0.2,3\n", ":2: 1 column where the lines above have 2"),
    "NaN": ("0,1\n0.1,nan\n", ":2: 'nan' is not allowed"),
    "infinite": ("0,1\n0.1,-inf\n", ":2: '-inf' is not allowed"),
    "back in time": ("0,1\n0.2,1\n0.1,1\n", ":3: time does not increase (0.1 s after 0.2 s)"),
    "twice the same time": ("0,1\n0.2,1\n0.2,2\n", ":3: time does not increase"),
    "a row missing": ("\n".join(EVEN[:40] + EVEN[41:]), ":41: a gap in time, from 0.39 s to 0.41 s where the step is"),
    "two gaps": ("\n".join(EVEN[:40] + EVEN[50:60] + EVEN[70:]), "and 1 more gaps; uneven = true if that is meant"),
    "one column": ("1\n2\n", ":1: one column; time and value are two, or give step"),
    "1_000 is no number": ("0,1_000\n1,2\n", ":1: '1_000' is not a number"),
    "two points": ("0 1.25.5\n1 2\n", ":1: '1.25.5' is not a number"),
    "whole numbers that touch": ("0 12-34\n1 2\n", ":1: '12-34' is not a number"),
    "three columns": ("1,2,3\n2,3,4\n", ":1: 3 columns; say which one holds the values"),
    "PEER too short": (peer(100, "0.01", np.ones(93)), ":4: NPTS says 100 values, the file has 93"),
    "PEER too long": (peer(90, "0.01", np.ones(93)), ":4: NPTS says 90 values, the file has 93"),
    "PEER without DT": (peer(5, "", np.ones(5), sizes="NPTS= {}{}"), ":4: DT is missing beside NPTS"),
    "PEER DT 0": (peer(5, "0.0", np.ones(5)), ":4: DT = 0 is not allowed"),
    "PEER word": (peer(5, "0.1", np.ones(5)) + "\nend", ":6: 'end' is not a number"),
    "PEER NaN": (peer(5, "0.1", [1, 2, np.nan, 3, 4]), ":5: 'NAN' is not allowed"),
    "PEER touching, one missing": ("NPTS= 4, DT= .1\n.1E+00.2E+00\n.3E+00\n", ":2: '.1E+00.2E+00' is not a number"),
}


@pytest.mark.parametrize("name", BAD)
def test_what_is_said_about_a_bad_file(tmp_path, name):
    text, message = BAD[name]
    (tmp_path / "r.csv").write_text(text)
    with pytest.raises(RecordError) as error:
        read_series(tmp_path / "r.csv")
    assert str(error.value).startswith("r.csv")
    assert message in str(error.value)
    assert "\n" not in str(error.value)


def test_a_gap_that_is_meant(tmp_path):
    (tmp_path / "r.csv").write_text("\n".join(EVEN[:40] + EVEN[50:]))
    assert len(read_series(tmp_path / "r.csv", uneven=True).times) == 90


def test_times_that_were_rounded_are_no_gaps(tmp_path):
    (tmp_path / "r.csv").write_text("\n".join(f"{i / 300:.3f} 1.0" for i in range(900)))
    assert len(read_series(tmp_path / "r.csv").times) == 900


def test_not_text_and_not_there(tmp_path):
    (tmp_path / "r.bin").write_bytes(b"0,1\n\x00\xff")
    with pytest.raises(RecordError, match=r"r.bin: not a text file \(byte 4\)"):
        read_series(tmp_path / "r.bin")
    with pytest.raises(RecordError, match="is a folder"):
        read_series(tmp_path)


def test_several_values_beside_a_step_are_asked_for(tmp_path):
    (tmp_path / "r.txt").write_text("1 2 3\n4 5\n")
    with pytest.raises(RecordError, match=r":2: 2 columns where the lines above have 3"):
        read_series(tmp_path / "r.txt", step=0.1)
    (tmp_path / "r.txt").write_text("1 2 3\n4 5 6\n")
    with pytest.raises(RecordError, match=r":1: 3 columns beside 'step'; say .* column = 'all'"):
        read_series(tmp_path / "r.txt", step=0.1)
    with pytest.raises(RecordError, match=r"column = 'all' needs a step"):
        read_series(tmp_path / "r.txt", column="all")


@settings(suppress_health_check=[HealthCheck.function_scoped_fixture])
@given(text=st.text(alphabet="0123456789.,;eE+- \t\n#nafNPTSDT=", max_size=80))
def test_whatever_is_in_a_file_is_read_or_refused(tmp_path, text):
    (tmp_path / "r.csv").write_text(text)
    try:
        found = read_series(tmp_path / "r.csv")
    except RecordError as refused:
        message = str(refused)
    else:
        message = ""
        assert np.isfinite(found.times).all()
        assert np.isfinite(found.values).all()
        assert (np.diff(found.times) > 0).all()
        assert len(found.times) == len(found.values) >= 2
    assert "\n" not in message


@pytest.mark.parametrize(
    ("header", "said"),
    [
        ("time [s], acceleration [g]", ("acceleration", "g")),
        ("t (s); a (cm/s^2)", ("acceleration", "cm/s2")),
        ("Zeit [s] Beschl. [m/s²]", ("acceleration", "m/s2")),
        ("v [cm/sec]", ("velocity", "cm/s")),
        ("# a [Gal]", ("acceleration", "gal")),
        ("t [s], a [g], v [cm/s]", (None, None)),  # of which column?
        ("time, acceleration", (None, None)),
        ("Station (m), height [m]", (None, None)),
    ],
)
def test_a_header_that_names_the_unit_of_the_values(tmp_path, header, said):
    path = tmp_path / "record.csv"
    path.write_text(header + "\n0.0 0.0\n0.1 0.5\n0.2 -0.5\n", encoding="utf-8")
    found = read_series(path)
    assert (found.quantity, found.unit) == said
