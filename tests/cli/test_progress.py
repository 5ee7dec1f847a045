"""The line on what a run does, which a thread redraws."""

import threading

from mfr_bench.cli.progress import Progress
from mfr_bench.run.events import Begun


def test_the_live_line_shows_life_at_sixty_columns(monkeypatch):
    """The time that has passed stands first, so that it moves however narrow the terminal is."""
    now = [100.0]
    monkeypatch.setattr("mfr_bench.cli.progress.time.monotonic", lambda: now[0])
    progress = Progress(28, "a-config-of-a-long-name-that-fills-the-line-of-a-terminal")
    before = progress._text().plain[:60]
    now[0] += 1
    assert progress._text().plain[:60] != before


class Learning:
    """A time left of which another thread asks in the midst of learning."""

    end_s, share = 0.0, 1.0

    def began(self, *event):
        self.asking = threading.Thread(target=self.ask, daemon=True)
        self.asking.start()
        self.asking.join(0.2)
        self.answered = not self.asking.is_alive()

    def left_s(self, elapsed_s):
        return 5.0


def test_the_live_line_is_not_made_while_the_time_left_learns():
    """It was: the thread met a dictionary that changed while it read it, and ended with a traceback."""
    progress, learning = Progress(28, "config"), Learning()
    progress.ahead, learning.ask = learning, progress._text
    progress.saw(Begun("key", "compile"))
    learning.asking.join()
    assert not learning.answered
    assert "5 s left" in progress._text().plain


def test_a_race_in_a_log_is_heard_while_no_cell_ends(monkeypatch, capsys):
    """For minutes nothing told a pipe that `decide` was at work: its cells end late, and many at once."""
    now = [100.0]
    monkeypatch.setattr("mfr_bench.cli.progress.time.monotonic", lambda: now[0])
    progress = Progress(3, "decide", until=130.0, pulse_s=2.0)
    for key in ("a", "b", "a", "c", "c", "c"):
        now[0] += 1.2
        progress.saw(Begun(key, "compile"))
    progress.row({"key": "a", "label": "A", "point": {}, "status": "ok", "reason": "", "values": {"time_ms": 2.5}})
    assert capsys.readouterr().err.splitlines() == [
        "decide 0/3, 28 s left to measure  2 of 3 begun",
        "decide 0/3, 25 s left to measure  drawing in turns",
        "decide 0/3, 23 s left to measure  drawing in turns",
        "decide 1/3, 23 s left to measure  A: 2.5 ms"]


def test_a_run_in_a_log_has_a_line_for_each_cell_alone(monkeypatch, capsys):
    now = [100.0]
    monkeypatch.setattr("mfr_bench.cli.progress.time.monotonic", lambda: now[0])
    progress = Progress(3, "smoke")
    now[0] += 1000
    progress.saw(Begun("a", "compile"))
    assert capsys.readouterr().err == ""
