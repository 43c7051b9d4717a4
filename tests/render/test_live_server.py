"""A live simulation as its readers meet it, without a browser: what it sends, heeds and refuses, and how it ends."""

import asyncio
import shlex
import subprocess
import sys
import tomllib
from itertools import pairwise

import aiohttp
import numpy as np
import pytest
from live_server import CHEAP, Live, is_alive

import tiswarm
from tiswarm.cli.options import assignment

PRESET = "delft/pronav-10"


@pytest.fixture(scope="module")
def scenario():
    return tiswarm.load(PRESET, dict(assignment(each) for each in CHEAP))


@pytest.fixture(scope="module")
def live():
    server = Live(PRESET)
    yield server
    if server.process.poll() is None:
        server.interrupt()


def test_a_frame_is_the_simulation_s_own_state(live, scenario, f32):
    async def deed(reader):
        await reader.say(act="play", on=False)
        await reader.say(act="restart", seed=7)
        await reader.until(lambda r: r.known.get("scene", {}).get("seed") == 7 and r.frame and r.frame["tick"] == 0)
        await reader.say(act="step")
        await reader.until(lambda r: r.frame["tick"] == 1)
        return reader

    reader = live.read(deed)
    header, frame = reader.known["scene"], reader.frame
    simulation = tiswarm.Simulation(scenario, seed=7)
    assert np.allclose(header["obstacles"], np.column_stack(simulation.obstacles), rtol=1e-6)
    simulation.step()
    both = [simulation.position("prey"), simulation.position("predators")]
    assert np.array_equal(frame["position"], np.concatenate(both).astype(np.float32))
    assert [header["states"][code] for code in frame["state"][:6]] == simulation.moment("prey").state.tolist()
    assert frame["counts"] == [6, 0, 0, 0]


def test_a_number_that_is_turned_counts_from_the_next_tick_on(live, scenario, f32):
    async def deed(reader):
        await reader.say(act="play", on=False)
        await reader.say(act="restart", seed=3)
        await reader.until(lambda r: r.known.get("scene", {}).get("seed") == 3 and r.frame and r.frame["tick"] == 0)
        await reader.say(act="set", path="prey.goal", value=0.4)
        await reader.until(lambda r: r.known["values"]["values"]["prey.goal"] == 0.4)
        serial = reader.known["values"]["serial"]
        await reader.until(lambda r: r.frame["heard"] == serial)
        await reader.say(act="step")
        await reader.until(lambda r: r.frame["tick"] == 1)
        frame = reader.frame
        await reader.say(act="set", path="prey.goal", value=0.1)
        return frame

    frame = live.read(deed)
    simulation = tiswarm.Simulation(scenario, seed=3)
    simulation.set({"prey.goal": 0.4})
    simulation.step()
    assert np.array_equal(frame["position"][:6], simulation.position("prey").astype(np.float32))


def test_a_thousand_trials_tell_what_a_batch_tells(live, scenario, f32):
    async def deed(reader):
        await reader.say(act="restart", seed=5)
        await reader.until(lambda r: r.known.get("state", {}).get("seed") == 5)
        await reader.say(act="set", path="predators.max_speed", value=0.25)
        await reader.until(lambda r: r.known["values"]["values"]["predators.max_speed"] == 0.25)
        serial = reader.known["values"]["serial"]
        await reader.until(lambda r: r.known["trials"]["serial"] == serial and r.known["trials"]["now"].get("trials") == 1000)
        return reader.known["trials"]

    told = live.read(deed)
    results = tiswarm.simulate(scenario.replaced({"predators.max_speed": 0.25}), 1000, seed=5)
    for name, (mean, low, high) in told["now"]["rows"].items():
        estimate = tiswarm.Estimate.of(results.measure(name))
        assert (mean, low, high) == (estimate.mean, estimate.low, estimate.high), name
    assert {"success", "captured", "time"} <= set(told["now"]["rows"])


def test_a_dropped_obstacle_stands_where_it_was_dropped_and_the_rest_goes_on(live):
    async def deed(reader):
        await reader.say(act="play", on=False)
        await reader.say(act="restart", seed=2)
        await reader.until(lambda r: r.known.get("scene", {}).get("seed") == 2 and r.frame and r.frame["tick"] == 0)
        for _ in range(3):
            await reader.say(act="step")
        await reader.until(lambda r: r.frame["tick"] == 3)
        before, scene = reader.frame, reader.known["scene"]
        await reader.say(act="drop", kind="obstacle", place=[40.0, 12.0])
        await reader.until(lambda r: r.frame["scene"] > scene["scene"])
        after, header = reader.frame, reader.known["scene"]
        await reader.say(act="drop", kind="predator", place=[20.0, 8.0])
        await reader.until(lambda r: r.frame["scene"] > header["scene"])
        return before, scene, after, header, reader.frame

    before, scene, after, header, last = live.read(deed)
    assert header["obstacles"][:-1] == scene["obstacles"]
    assert header["obstacles"][-1][:2] == [40.0, 12.0]
    assert after["tick"] == 3
    assert np.array_equal(after["position"], before["position"])
    assert header["ticks"] == scene["ticks"] == 60
    assert np.allclose(last["position"][-1], [20, 8])
    assert len(last["position"]) == len(before["position"]) + 1


def test_another_strategy_is_compiled_while_the_old_one_runs_on(live):
    async def deed(reader):
        await reader.say(act="play", on=True)
        await reader.say(act="speed", speed=5)
        await reader.until(lambda r: r.known.get("state", {}).get("playing") and r.known["state"]["speed"] == 5)
        await reader.say(act="set", path="prey.strategy", value="evasive")
        await reader.until(lambda r: r.known["state"]["building"])
        told, frames = reader.known["state"]["building"], reader.frames
        await reader.until(lambda r: not r.known["state"]["building"])
        while_building = reader.frames - frames
        await reader.until(lambda r: r.known["scene"]["prey"]["strategy"] == "evasive")
        await reader.say(act="set", path="prey.weights.evade", value=0.03)
        await reader.until(lambda r: r.known["values"]["values"].get("prey.weights.evade") == 0.03)
        return told, while_building, reader.known

    told, while_building, known = live.read(deed)
    assert told == "prey.strategy=evasive, prey.weights.evade=0.01"
    assert while_building > 5
    (evade,) = [each for each in known["knobs"]["knobs"] if each["path"] == "prey.weights.evade"]
    assert (evade["words"], evade["unit"], evade["high"]) == ("strength", "1/s", 0.04)


def test_a_preset_and_a_film_have_the_numbers_of_now(live, tmp_path):
    async def deed(reader):
        await reader.say(act="set", path="prey.cohesion", value=0.015)
        await reader.until(lambda r: r.known.get("values", {}).get("values", {}).get("prey.cohesion") == 0.015)
        return reader.known["values"]["film"]

    film = live.read(deed)
    status, headers, text = live.get("preset.toml")
    assert status == 200
    assert headers["Content-Disposition"].startswith("attachment")
    (tmp_path / "mine.toml").write_text(text)
    saved = tiswarm.load(str(tmp_path / "mine.toml"))
    words = shlex.split(film)
    assert words[:3] == ["tiswarm", "film", PRESET]
    sets = dict(assignment(word) for before, word in pairwise(words) if before == "--set")
    assert saved.hash() == tiswarm.load(PRESET, sets).hash()
    assert tomllib.loads(text)["prey"]["cohesion"] == 0.015


@pytest.mark.parametrize(
    ("message", "said"),
    [
        ({"act": "set", "path": "prey.goal", "value": "much"}, "is no number"),
        ({"act": "set", "path": "prey.perception", "value": -1}, "is not possible; use 0 to"),
        ({"act": "set", "path": "world.size", "value": 3}, "cannot be turned here"),
        ({"act": "set", "path": "prey.strategy", "value": "../../x"}, "is unknown; use one of"),
        ({"act": "drop", "kind": "bomb", "place": [1, 2]}, "only obstacles and predators"),
        ({"act": "restart", "seed": -1}, "seed"),
        ({"act": "os.system"}, "no act of this page"),
        ([[[]]], "no act of this page"),
    ],
)
def test_what_cannot_be_gets_a_line_and_changes_nothing(live, message, said):
    async def deed(reader):
        await reader.until(lambda r: "values" in r.known)
        before = reader.known["values"]["values"]
        await reader.socket.send_json(message)
        await reader.until(lambda r: "note" in r.known)
        return before, reader.known["values"]["values"], reader.known["note"]

    before, after, note = live.read(deed)
    assert said in note["words"]
    assert note["wrong"]
    assert before == after


def test_only_this_machine_s_page_gets_in(live):
    status, headers, _ = live.get()
    assert status == 200
    policy = headers["Content-Security-Policy"]
    assert policy.startswith("default-src 'none'; script-src 'sha256-")
    assert f"connect-src ws://127.0.0.1:{live.port};" in policy
    assert "unsafe" not in policy
    assert "frame-ancestors 'none'" in policy
    assert headers["Referrer-Policy"] == "no-referrer"
    assert live.get(host="evil.example")[0] == 403
    assert live.get("socket", host=f"evil.example:{live.port}")[0] == 403
    own, live.address = live.address, f"http://127.0.0.1:{live.port}/guessed/"
    try:
        refused = live.get()
        assert refused[0] == 403
        assert own.split("/")[3] not in refused[2]
        with pytest.raises(aiohttp.WSServerHandshakeError, match="403"):
            live.read(asyncio.sleep)
    finally:
        live.address = own
    for origin in ("http://evil.example", "null", f"http://localhost:{live.port}"):
        with pytest.raises(aiohttp.WSServerHandshakeError, match="403"):
            live.read(asyncio.sleep, origin=origin)


def test_a_slow_reader_gets_the_newest_frame_and_keeps_nobody_waiting(live):
    async def deed(reader):
        reader.acknowledges = False
        await reader.say(act="speed", speed=5)
        await reader.say(act="play", on=True)
        await reader.until(lambda r: r.frames == 2)
        held = reader.frame["scene"], reader.frame["tick"]
        with pytest.raises(TimeoutError):
            await asyncio.wait_for(reader.until(lambda r: r.frames > 2), 1.5)
        for _ in range(2):
            await reader.say(act="seen")
        await reader.until(lambda r: r.frames == 3)
        return held, (reader.frame["scene"], reader.frame["tick"])

    held, newest = live.read(deed)
    assert newest[0] > held[0] or newest[1] > held[1] + 5  # what was not sent would be the next, or the one after


def test_ctrl_c_ends_all_of_it_without_a_word():
    server = Live(PRESET)
    try:
        children = server.children(2)
        assert len(children) == 2
    finally:
        ended = server.interrupt()
    assert ended == (0, "")
    assert not any(map(is_alive, children))


def test_a_port_that_is_taken_gets_one_line(live):
    command = [sys.executable, "-m", "tiswarm", "live", PRESET, "--port", str(live.port)]
    done = subprocess.run(command, capture_output=True, text=True, timeout=60, check=False)
    assert done.returncode == 2
    assert done.stderr == f"tiswarm: --port {live.port}: is taken; use another one, or --port 0 for any that is free\n"
    assert done.stdout == ""
