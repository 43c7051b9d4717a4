"""Files are whole or not there; links stay links; what dead runs left is swept, what living ones own is not."""

import errno
import os
import subprocess
import sys

import pytest

from tiswarm.system import files
from tiswarm.system.files import replacing, replacing_folder, write_text
from tiswarm.system.owner import Owner

pytestmark = pytest.mark.quick

KILLED = """
import os, signal, sys
from pathlib import Path
from tiswarm.system.files import replacing, replacing_folder
folder = Path(sys.argv[1])
with replacing(folder / "trials.csv"), replacing(folder / "x.png"), replacing_folder(folder / "frames") as frames:
    (frames / "frame-00001.png").write_text("half")
    print("\\n".join(each.name for each in folder.iterdir()), flush=True)
    if sys.argv[2] == "kill":
        os.kill(os.getpid(), signal.SIGKILL)
    sys.stdin.read()
"""


def _run(folder, how):
    return subprocess.Popen(
        [sys.executable, "-c", KILLED, folder, how], stdout=subprocess.PIPE, stdin=subprocess.PIPE, text=True
    )


def test_what_a_killed_run_left_goes_with_the_next_file(tmp_path):
    killed = _run(tmp_path, "kill")
    killed.communicate(timeout=30)
    assert len([each for each in tmp_path.iterdir() if ".part" in each.name]) == 3
    (tmp_path / ".mine.part.csv").write_text("not of tiswarm")
    write_text(tmp_path / "a.txt", "a")
    assert sorted(each.name for each in tmp_path.iterdir()) == [".mine.part.csv", "a.txt"]


def test_what_a_living_run_owns_stays(tmp_path):
    living = _run(tmp_path, "wait")
    names = {living.stdout.readline().strip() for _ in range(3)}
    write_text(tmp_path / "a.txt", "a")
    assert names <= {each.name for each in tmp_path.iterdir()}
    living.communicate("", timeout=30)
    assert sorted(each.name for each in tmp_path.iterdir()) == ["a.txt", "frames", "trials.csv", "x.png"]


def test_what_lies_on_another_machine_stays(tmp_path):
    name = f".x.{Owner('00000000', 1, 'ff').mark}.abcdefgh.part.csv"
    (tmp_path / name).write_text("")
    write_text(tmp_path / "a.txt", "a")
    assert (tmp_path / name).exists()


def test_a_link_is_written_through(tmp_path):
    (tmp_path / "far").mkdir()
    (tmp_path / "far" / "a.txt").write_text("old")
    (tmp_path / "link.txt").symlink_to("far/a.txt")
    (tmp_path / "dangling.txt").symlink_to("far/b.txt")
    (tmp_path / "frames").symlink_to("far/frames")
    for name in ("link.txt", "dangling.txt"):
        write_text(tmp_path / name, "new")
    with replacing_folder(tmp_path / "frames") as part:
        (part / "1").write_text("")
    assert all((tmp_path / name).is_symlink() for name in ("link.txt", "dangling.txt", "frames"))
    assert sorted(each.name for each in (tmp_path / "far").iterdir()) == ["a.txt", "b.txt", "frames"]
    assert (tmp_path / "far" / "a.txt").read_text() == "new"


@pytest.mark.parametrize(
    "name", ["x" * 251 + ".txt", "ü" * 125 + ".txt", "a." + "x" * 253, "a\nb.txt", "%d%05d.txt", "a:b.txt"]
)
def test_a_legal_name_is_possible(name, tmp_path):
    write_text(tmp_path / name, "text")
    assert [each.name for each in tmp_path.iterdir()] == [name]


@pytest.mark.parametrize("error", [OSError(errno.ENOSPC, "No space left on device"), OSError("of no number"), None])
def test_errors_of_the_system_name_the_file_that_was_wanted(error, tmp_path):
    def write(inside):
        with replacing(tmp_path / "a.txt") as part:
            part.unlink()
            if error:
                raise error
            (part if inside else tmp_path / "b.txt").open("rb")

    with pytest.raises(OSError, match=r"a\.txt|of no number") as caught:
        write(inside=True)
    assert caught.value.filename == str(tmp_path / "a.txt")
    if error is None:
        with pytest.raises(FileNotFoundError, match=r"b\.txt"):
            write(inside=False)
    assert list(tmp_path.iterdir()) == []


def test_a_durable_file_and_its_folder_are_on_the_disc_before_it_counts(tmp_path, monkeypatch):
    synced = []
    monkeypatch.setattr(os, "fsync", lambda file: synced.append((os.fstat(file).st_ino, (tmp_path / "a").exists())))
    with replacing(tmp_path / "a", durable=True) as part:
        part.write_text("a")
    assert synced == [((tmp_path / "a").stat().st_ino, False), (tmp_path.stat().st_ino, True)]
    with replacing(tmp_path / "b"):
        pass
    assert len(synced) == 2


def test_more_than_is_allowed_is_not_read(tmp_path):
    (tmp_path / "a").write_bytes(b"12345")
    assert files.read_bounded(tmp_path / "a", 5) == b"12345"
    with pytest.raises(ValueError, match="larger than 4 bytes"):
        files.read_bounded(tmp_path / "a", 4)
