"""A live server of tests, started as people start it, and a reader without a browser."""

import asyncio
import json
import os
import signal
import struct
import subprocess
import sys
import time
from collections.abc import Callable
from urllib.parse import urlsplit

import aiohttp
import numpy as np

CHEAP = ("prey.avoidance=none", "predators.avoidance=none", "predators.strategy=centre", "world.ticks=60")
"""What makes the kernel of delft/pronav-10 quick to compile."""


class Live:
    """`tiswarm live` in a process."""

    def __init__(self, preset: str, *words: str, sets: tuple[str, ...] = CHEAP):
        """Start it, and wait for its address."""
        command = [sys.executable, "-m", "tiswarm", "live", preset, "--port", "0", "--quiet", *words]
        for each in sets:
            command += ["--set", each]
        self.process = subprocess.Popen(command, stdout=subprocess.PIPE, stderr=subprocess.PIPE, text=True)
        self.address = self.process.stdout.readline().strip()
        assert self.address.startswith("http://127.0.0.1:"), self.process.stderr.read()
        self.port = urlsplit(self.address).port

    def children(self, count: int) -> list[int]:
        """Wait for the processes that it starts, those that run Taichi, and list them."""
        last = time.monotonic() + 30
        while True:
            # -ww: however narrow the terminal, a command's words are whole.
            command = ["ps", "-ww", "-o", "pid=,args=", "--ppid", str(self.process.pid)]
            listed = subprocess.run(command, capture_output=True, text=True)  # noqa: PLW1510
            found = [int(line.split()[0]) for line in listed.stdout.splitlines() if "spawn_main" in line]
            if len(found) == count or time.monotonic() > last:
                return found
            time.sleep(0.02)

    def interrupt(self) -> tuple[int, str]:
        """Press Ctrl-C; give the exit code and what was said on standard error."""
        self.process.send_signal(signal.SIGINT)
        _, said = self.process.communicate(timeout=20)
        return self.process.returncode, said

    def get(self, place: str = "", host: str | None = None) -> tuple[int, dict[str, str], str]:
        """Ask for something; give status, headers and text."""

        async def asked():
            headers = {"Host": host} if host else {}
            async with aiohttp.ClientSession() as session, session.get(self.address + place, headers=headers) as answer:
                return answer.status, dict(answer.headers), await answer.text()

        return asyncio.run(asked())

    def read(self, deed: Callable, origin: str | None = None):
        """Connect as the page does, and let an async function of a Reader do something."""

        async def done():
            headers = {"Origin": origin or f"http://127.0.0.1:{self.port}"}
            async with (
                aiohttp.ClientSession() as session,
                session.ws_connect(self.address + "socket", headers=headers, max_msg_size=0) as socket,
            ):
                return await asyncio.wait_for(deed(Reader(socket)), 90)

        return asyncio.run(done())


class Reader:
    """Somebody who looks without a browser."""

    def __init__(self, socket):
        """Begin with nothing known."""
        self.socket = socket
        self.known: dict[str, dict] = {}
        self.frame: dict | None = None
        self.frames = 0
        self.acknowledges = True

    async def next(self) -> None:
        """Hear one message."""
        message = await self.socket.receive()
        if message.type == aiohttp.WSMsgType.TEXT:
            told = json.loads(message.data)
            self.known[told["kind"]] = told
        elif message.type == aiohttp.WSMsgType.BINARY:
            self.frame = frame(message.data)
            self.frames += 1
            if self.acknowledges:
                await self.say(act="seen")
        else:
            raise ConnectionError(str(message))

    async def until(self, holds: Callable[["Reader"], bool]) -> None:
        """Hear messages until something holds."""
        while not holds(self):
            await self.next()

    async def say(self, **message) -> None:
        """Do something."""
        await self.socket.send_str(json.dumps(message))


def frame(raw: bytes) -> dict:
    """Read a frame as its module describes it, not as the page's code does."""
    head = struct.unpack_from("<12I", raw)
    lone, cloud, dim = head[9:]
    told = {"scene": head[1], "tick": head[2], "heard": head[3], "ended": bool(head[4]), "counts": list(head[5:9]), "dim": dim}
    at = 48
    for name, kind, count in (
        *(("position", "<f4", lone * dim), ("velocity", "<f4", lone * dim), ("group", "<i2", lone)),
        *(("cloud", "<u2", cloud * dim), ("state", "u1", lone), ("fate", "u1", lone)),
    ):
        values = np.frombuffer(raw, kind, count, at)
        told[name] = values.reshape(-1, dim) if name in ("position", "velocity", "cloud") else values
        at += values.nbytes
    assert at == len(raw)
    return told


def is_alive(pid: int) -> bool:
    """Tell whether a process runs."""
    try:
        os.kill(pid, 0)
    except ProcessLookupError:
        return False
    return True
