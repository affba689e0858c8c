"""`roundabout replay` in a terminal, key by key: replay_keys_test.py ROUNDABOUT MODULES"""

import os
import pty
import re
import select
import struct
import sys
import tempfile
import time

roundabout, modules = sys.argv[1:]
sys.path.insert(0, modules)
from roundabout.transport import Transport

URL = f"udpm://239.255.76.67:{10000 + os.getpid() % 20000}?ttl=0"
LENGTH_S, RATE_HZ = 60, 20
LINE = re.compile(r"(paused|playing) +([0-9.]+) / ([0-9.]+) s +× ([0-9.]+)(  loop)? +([0-9]+) events")
LEFT, RIGHT, UP, DOWN = "\033[D", "\033[C", "\033[A", "\033[B"


def write_log(path):
    """Frames and, between them, other messages; each says which it is."""
    with open(path, "wb") as log:
        for i in range(2 * LENGTH_S * RATE_HZ):
            channel = b"VEHICLE_STATES" if i % 2 == 0 else b"OTHER"
            payload = struct.pack(">q", i)
            utime = 1_700_000_000_000_000 + i * 500_000 // RATE_HZ
            log.write(struct.pack(">IqqII", 0xEDA1DA01, i, utime, len(channel), len(payload)) + channel + payload)


class Replay:
    """The program in a terminal of its own, and what it shows and publishes."""

    def __init__(self, log):
        self.heard = []
        self.lcm = Transport(URL)
        for name in ("VEHICLE_STATES", "OTHER"):
            self.lcm.subscribe(name, lambda channel, data: self.heard.append((channel, struct.unpack(">q", data)[0])))
        self.shown = ""
        self.pid, self.terminal = pty.fork()
        if self.pid == 0:
            os.execv(roundabout, [roundabout, "replay", log, "--paused", "--lcm-url", URL])

    def look(self, seconds=0.05):
        self.lcm.handle(0.0)
        if select.select([self.terminal], [], [], seconds)[0]:
            try:
                self.shown += os.read(self.terminal, 4096).decode(errors="replace")
            except OSError:
                return False  # it has ended
        return True

    def state(self):
        """(paused, position, speed, loop) as shown last."""
        lines = LINE.findall(self.shown)
        if not lines:
            return None
        word, at, _, speed, loop, _ = lines[-1]
        return word == "paused", float(at), float(speed), bool(loop)

    def until(self, what, condition):
        deadline = time.monotonic() + 15.0
        while time.monotonic() < deadline:
            self.look()
            state = self.state()
            if state and condition(*state):
                return state
        raise AssertionError(f"not seen within 15 s: {what}; it shows {self.state()}")

    def press(self, keys):
        os.write(self.terminal, keys.encode())

    def expect(self, what, keys, condition):
        self.press(keys)
        state = self.until(what, condition)
        print(f"{what}: {state}")
        return state


def near(a, b):
    return abs(a - b) < 0.11


with tempfile.TemporaryDirectory() as folder:
    log = os.path.join(folder, "flight.lcm")
    write_log(log)
    replay = Replay(log)
    replay.until("paused at the begin", lambda paused, at, *_: paused and at == 0.0)
    for _ in range(10):
        replay.look()
    assert replay.heard == [], "it plays although it is paused"

    replay.expect("right seeks 5 s on", RIGHT, lambda paused, at, *_: paused and near(at, 5.0))
    replay.expect("and again, twice at once", RIGHT + RIGHT, lambda paused, at, *_: near(at, 15.0))
    replay.expect("left seeks 5 s back", LEFT, lambda paused, at, *_: near(at, 10.0))
    assert replay.heard == [], "seeking publishes nothing"

    replay.expect("s steps to a frame", "s", lambda paused, at, *_: paused)
    deadline = time.monotonic() + 5.0
    while not any(channel == "VEHICLE_STATES" for channel, _ in replay.heard) and time.monotonic() < deadline:
        replay.look()
    frames = [number for channel, number in replay.heard if channel == "VEHICLE_STATES"]
    assert frames == [2 * RATE_HZ * 10], (frames, "one frame, the one of 10 s")

    replay.expect("up doubles the speed", UP + UP, lambda paused, at, speed, loop: speed == 4.0)
    replay.expect("down halves it", DOWN, lambda paused, at, speed, loop: speed == 2.0)
    replay.expect("l loops", "l", lambda paused, at, speed, loop: loop)
    replay.expect("space plays", " ", lambda paused, at, *_: not paused and at > 11.0)
    replay.expect("space pauses", " ", lambda paused, *_: paused)
    numbers = [number for _, number in replay.heard]
    assert numbers == list(range(numbers[0], numbers[-1] + 1)), "every message, once, in order"

    replay.expect("0 goes to the begin", "0", lambda paused, at, *_: at == 0.0)
    replay.expect("left of the begin is the begin", LEFT, lambda paused, at, *_: at == 0.0)
    replay.expect("near the end", RIGHT * 11, lambda paused, at, *_: near(at, 55.0))
    replay.press(UP + UP + " ")
    replay.until("it begins again after the end", lambda paused, at, *_: at < 50.0)
    replay.press("x\033q")  # what is no key is passed over
    while replay.look():
        pass
    _, status = os.waitpid(replay.pid, 0)
    assert os.waitstatus_to_exitcode(status) == 0, status
print("every key does what docs/replay.md says")
