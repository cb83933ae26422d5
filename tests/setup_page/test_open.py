"""`sigmahat open` in a browser, from a log without configuration to the results."""

import http.client
import os
import socket
import stat
import sys
import time
from pathlib import Path
from urllib.parse import urlsplit
from urllib.request import url2pathname

import pytest
import tomlkit

from browser import opened
from checked_logs import knee_log
from command_line import Shell
from recorded_logs import write_log
from served_page import Hand, served
from sigmahat.setup_page import server


def by_hand(text: str) -> str:
    """Edits the configuration from `init` as a user would in a text editor."""
    for key, value in (("counts_per_turn", "4096"), ("torque_constant", "0.05")):
        text = text.replace(f"{key} = 0 ", f"{key} = {value} ")
    text = text.replace("gear_ratio = 0 ", "gear_ratio = 100 ")
    return text.replace("motor.D_theta = 0.001 ", "motor.D_theta = 5e-4 ")


def fill_in(hand: Hand) -> None:
    """Edits the configuration on the web page as in by_hand(), with one typing error."""
    hand.types("ports.theta.counts_per_turn", "4096")
    hand.types("ports.theta.gear_ratio", "1OO")
    hand.sees("ports.theta.gear_ratio: expected a number, got '1OO'")
    hand.types("ports.theta.gear_ratio", "100")
    hand.types("ports.tau.torque_constant", "0.05")


@pytest.mark.slow("two browsers, five checks and curves, an identification")
def test_from_an_empty_configuration_to_the_results(shell: Shell) -> None:
    """GIVEN edits in one browser window, THEN a second, narrow and dark window shows the edits."""
    write_log(knee_log(), Path("knee.csv"))
    with served("knee.csv", folder=Path()) as page:
        with opened(page.address) as first, opened(page.address, 400, dark=True) as second:
            hand, other = Hand(first), Hand(second)
            hand.sees("Fill in: ports.theta.counts_per_turn, ports.theta.gear_ratio")
            assert hand.value("ports.theta.column") == "motor_counts"
            fill_in(hand)
            hand.chooses("ports.q.sign", "-1: turned round")
            said = "ports.q.sign: q moves against theta"
            first.until(lambda: hand.text().count(said) == 2, "below the result, and in the checks")
            hand.accepts("ports.q.sign")
            second.until(lambda: other.value("ports.q.sign") == "+1", "the sign is right again")
            hand.types("motor.D_theta", "5e-4")
            second.until(lambda: other.value("motor.D_theta") == "0.0005", "the edit has arrived")
            other.sees("nothing in 20.001 s of the log contradicts the configuration")
            other.sees("the stiffness as a curve")
            other.presses("write")
            hand.sees("Written:")
            middle = shell.json("estimate knee.csv")["curve"][1]
            low, high = middle["interval"]
            assert low < 1000 < high
            other.sees(f"{middle['sigma']:.4g} {low:.4g} to {high:.4g}")
            assert "phi^11" not in hand.text()  # nobody has chosen this power
            written = tomlkit.parse(Path("knee.toml").read_text()).unwrap()
            hand.presses("estimate")  # also runs identify
            hand.sees("Results: ")
            assert float(hand.value("motor.B")) == pytest.approx(1e-4, rel=0.01)
            assert Path("sigmahat-results/knee/estimate.png").is_file()
            hand.sees(shell.json("estimate knee.csv")["answer"])
            place = first.run("return document.querySelector('h1').nextElementSibling.offsetTop")
            assert place < 100  # visible without scrolling
            for each in (first, second):
                assert each.complaints() == []
                asked = {urlsplit(url).netloc for url in each.requests()}
                assert asked == {urlsplit(page.address).netloc}
                wide, there = each.run("return [document.body.scrollWidth, innerWidth]")
                assert wide <= there
        assert page.interrupt() == (0, "", "")
    shell.run("init knee.csv --config own.toml")
    assert written == tomlkit.parse(by_hand(Path("own.toml").read_text())).unwrap()


@pytest.mark.slow("a browser")
def test_nothing_is_lost_when_the_log_vanishes_and_at_the_end(tmp_path: Path) -> None:
    log = write_log(knee_log(), tmp_path / "knee.parquet")
    kept = tmp_path / "knee.toml"
    kept.write_text("[ports.q]\ncolumn = 'link_deg'   # mine\n[parameters]\nmotor.B = 1e-4\n")
    before = kept.read_text()
    with served("knee.parquet", folder=tmp_path, browser="false") as page:
        with opened(page.address) as window:
            hand = Hand(window)
            hand.sees("Not checked: modality Residual needs [ports.theta]")
            log.unlink()  # the page has opened the log
            hand.chooses("modality", "Model")
            hand.sees("assumptions that no log can verify")
            hand.types("motor.B", "2e-4")
            hand.presses("write")
            hand.sees("exists, and differs from what is shown here")
            window.driver.get(page.address)  # loads the page again
            assert hand.value("motor.B") == "0.0002"
        status, out, err = page.interrupt()
    assert (status, err) == (0, "")
    assert "No browser was opened" in out
    assert "sigmahat open knee.parquet --config knee.draft.toml" in out
    assert kept.read_text() == before
    draft = (tmp_path / "knee.draft.toml").read_text()
    assert "# mine" in draft
    expected = {"motor": {"B": 2e-4}, "modality": "Model"}
    assert tomlkit.parse(draft).unwrap()["parameters"] == expected


def test_only_who_has_the_address_is_served(tmp_path: Path) -> None:
    write_log(knee_log(), tmp_path / "knee.csv")
    browser, argument = tmp_path / "browser", tmp_path / "argument"
    browser.write_text(f'#!/bin/sh\necho "$1" > {argument}.part; mv {argument}.part {argument}\n')
    browser.chmod(0o755)
    with served("knee.csv", folder=tmp_path, browser=str(browser)) as page:
        where = urlsplit(page.address)
        assert where.hostname == "127.0.0.1"
        assert len(where.path) > 20

        def status(path: str, **headers: str) -> int:
            connection = http.client.HTTPConnection(where.netloc)
            connection.request("GET", path, headers=headers)
            return connection.getresponse().status

        assert status(where.path) == 200
        assert [status("/"), status("/other"), status(f"{where.path}x")] == [404] * 3
        upgrade = {
            "Upgrade": "websocket",
            "Connection": "Upgrade",
            "Sec-WebSocket-Version": "13",
            "Sec-WebSocket-Key": "dGhlIHNhbXBsZSBub25jZQ==",
        }
        assert status(f"{where.path}/ws", Origin="http://example.org", **upgrade) == 403
        until = time.monotonic() + 60
        while not argument.exists() and time.monotonic() < until:
            time.sleep(0.01)  # the browser is a process of its own
        link = argument.read_text().strip()
        assert where.path not in link  # every user of the computer sees the arguments
        leads = Path(url2pathname(urlsplit(link).path))
        assert page.address in leads.read_text()
        assert stat.S_IMODE(leads.stat().st_mode) == 0o600
        page.interrupt()
        assert not leads.exists()


@pytest.mark.skipif(sys.platform == "win32", reason="Windows has no RLIMIT_NOFILE")
def test_connections_wait_for_file_handles(monkeypatch: pytest.MonkeyPatch) -> None:
    """The event loop neither spins nor fails while there are none."""
    import resource

    monkeypatch.setattr(server, "_RETRY", 0.0)
    with socket.socket() as opened:
        opened.bind(("127.0.0.1", 0))
        opened.listen()
        listening = server._Listening(fileno=opened.detach())
    with listening, socket.create_connection(listening.getsockname()) as client:
        free, limits = os.dup(client.fileno()), resource.getrlimit(resource.RLIMIT_NOFILE)
        os.close(free)
        resource.setrlimit(resource.RLIMIT_NOFILE, (free, limits[1]))
        try:
            with pytest.raises(BlockingIOError):
                listening.accept()
        finally:
            resource.setrlimit(resource.RLIMIT_NOFILE, limits)
        listening.accept()[0].close()


@pytest.mark.parametrize(
    ("arguments", "said"),
    [
        ("absent.csv", "absent.csv: No such file or directory"),
        ("knee.csv --config broken.toml", "broken.toml: not TOML"),
        ("knee.csv --port {port}", "port {port} cannot be used (Address already in use)"),
    ],
)
def test_bad_input_is_refused_in_one_line(arguments: str, said: str, shell: Shell) -> None:
    write_log(knee_log(), Path("knee.csv"))
    Path("broken.toml").write_text("[ports")
    with socket.create_server(("127.0.0.1", 0)) as taken:
        port = taken.getsockname()[1]
        assert said.format(port=port) in shell.refused(f"open {arguments.format(port=port)}")
