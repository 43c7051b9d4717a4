"""Whatever stops a film, no file is left under its name, no part of one, and no process."""

import os
import signal
import subprocess
import sys
import textwrap
import threading
from pathlib import Path

import pytest

import render
from render import encoder

FILM = """
    import resource, sys
    from pathlib import Path
    sys.path.insert(0, {tests!r})
    import render
    from conftest import make
    recording = make.__wrapped__()(ticks=300)
"""


def children() -> set[int]:
    """List the child processes of this one."""
    found = set()
    for status in Path("/proc").glob("[0-9]*/stat"):
        try:
            fields = status.read_text().rpartition(")")[2].split()
        except OSError:
            continue
        if int(fields[1]) == os.getpid() and fields[0] != "Z":
            found.add(int(status.parent.name))
    return found


@pytest.fixture(autouse=True)
def _nothing_is_left(tmp_path):
    before = children()
    yield
    assert children() <= before
    assert not [each for each in tmp_path.rglob("*") if each.is_file()]


def test_an_encoder_killed_in_the_middle(make, tmp_path):
    before = children()

    def kill(done: int, total: int) -> None:
        if done == 20:
            for process in children() - before:
                os.kill(process, signal.SIGKILL)

    with pytest.raises(render.FilmError, match="SIGKILL"):
        render.film(make(ticks=100), tmp_path / "a.mp4", (320, 180), progress=kill)


def test_an_interruption_in_the_middle(make, tmp_path):
    def interrupt(done: int, total: int) -> None:
        if done == 20:
            raise KeyboardInterrupt

    with pytest.raises(KeyboardInterrupt):
        render.film(make(ticks=100), tmp_path / "a.mp4", (320, 180), progress=interrupt)
    assert threading.active_count() == 1 or all(t.name != "film encoder" for t in threading.enumerate())


def test_a_target_that_cannot_be_written(make, tmp_path):
    (tmp_path / "folder.mp4").mkdir()
    with pytest.raises(render.FilmError, match=r"folder\.mp4"):
        render.film(make(), tmp_path / "folder.mp4", (64, 64))
    with pytest.raises(render.FilmError, match="cannot be written"):
        render.film(make(), Path("/proc/nowhere/a.mp4"), (64, 64))
    with pytest.raises(render.FilmError, match="cannot be written"):
        render.poster(make(), Path("/proc/nowhere/a.png"), (64, 64))
    (tmp_path / "folder.mp4").rmdir()


def test_an_encoder_that_complains_is_quoted(make, tmp_path, monkeypatch):
    real = encoder._command
    monkeypatch.setattr(encoder, "_command", lambda *what: [*real(*what)[:-1], "-unknown-choice", "1", str(what[0])])
    with pytest.raises(render.FilmError, match=r"the encoder failed: .*Option not found"):
        render.film(make(), tmp_path / "a.mp4", (64, 64))


def test_an_encoder_that_is_not_there(make, tmp_path, monkeypatch):
    monkeypatch.setenv("IMAGEIO_FFMPEG_EXE", str(tmp_path / "nowhere"))
    import imageio_ffmpeg

    monkeypatch.setattr(imageio_ffmpeg, "get_ffmpeg_exe", lambda: str(tmp_path / "nowhere"))
    with pytest.raises(render.FilmError, match="cannot be written"):
        render.film(make(), tmp_path / "a.mp4", (64, 64))


def test_what_was_there_before_stays_when_a_film_fails(make, tmp_path):
    old = tmp_path / "a.mp4"
    old.write_text("old")

    def stop(done: int, total: int) -> None:
        raise RuntimeError("enough")

    with pytest.raises(RuntimeError, match="enough"):
        render.film(make(), old, (64, 64), progress=stop)
    assert old.read_text() == "old"
    old.unlink()


def test_a_full_disc(tmp_path):
    """A limit on the size of files stands in for it, in a process of its own."""
    program = textwrap.dedent(FILM.format(tests=str(Path(__file__).parent))) + textwrap.dedent(
        f"""
        resource.setrlimit(resource.RLIMIT_FSIZE, (20_000, 20_000))
        try:
            render.film(recording, {str(tmp_path / "a.mp4")!r}, (640, 360), quality="best")
        except render.FilmError as error:
            sys.exit(f"said: {{error}}")
        """
    )
    ran = subprocess.run(
        [sys.executable, "-c", program],
        check=False,
        capture_output=True,
        text=True,
        env=os.environ | {"TI_OFFLINE_CACHE": "0", "TI_OFFLINE_CACHE_FILE_PATH": str(tmp_path / "kernels")},
    )
    assert ran.returncode == 1
    assert "said:" in ran.stderr
    assert "a.mp4" in ran.stderr


def test_ctrl_c_from_the_terminal(tmp_path):
    program = textwrap.dedent(FILM.format(tests=str(Path(__file__).parent))) + textwrap.dedent(
        f"""
        def tell(done, total):
            if done == 10:
                print("rolling", flush=True)
        render.film(recording, {str(tmp_path / "a.mp4")!r}, (640, 360), progress=tell)
        """
    )
    running = subprocess.Popen(
        [sys.executable, "-c", program], stdout=subprocess.PIPE, stderr=subprocess.PIPE, start_new_session=True
    )
    assert running.stdout is not None
    while (line := running.stdout.readline()) and b"rolling" not in line:
        pass
    os.killpg(running.pid, signal.SIGINT)
    _, words = running.communicate(timeout=30)
    assert running.returncode != 0
    assert b"KeyboardInterrupt" in words
