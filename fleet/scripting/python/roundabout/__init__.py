"""Fly a fleet from a script.

    from roundabout import Fleet

    with Fleet() as fleet:
        fleet.take_off()
        fleet.spell("HI")
        fleet.land()

Frames are those of Roundabout: metres, z up, x and y span the floor. Every verb waits until the fleet has done it; with
wait=False it returns as soon as the fleet has taken it, and what comes next queues behind it. What the fleet refuses is raised
as Refused, with the fleet's own reason.
"""

import math
import os
import time
from dataclasses import dataclass

from roundabout_msgs import fleet_status_t, mission_t, safety_order_t, vehicle_states_t

from .transport import DEFAULT_URL, connect

__all__ = ["Fleet", "FleetError", "FleetForgot", "FleetLost", "MissionFailed", "Refused", "State", "TimedOut"]

WAITING, IDLE, TAKE_OFF, GO, HOLD, LAND, DONE, FAILED = range(8)
PHASES = ("waiting", "idle", "take_off", "go", "hold", "land", "done", "failed")


class FleetError(RuntimeError):
    """Whatever ends what a script wanted."""


class Refused(FleetError):
    """The fleet will not do it. str() is its reason: "goals 3 and 5 are 0.40 m apart and must be 1.10"."""


class FleetLost(FleetError):
    """The fleet has not been heard for Fleet.patience_s. Vehicles hold at their goals."""


class FleetForgot(FleetError):
    """The fleet was restarted, and no longer knows what it was told. Vehicles stay at their goals."""


class MissionFailed(FleetError):
    """The fleet gave up on a step and lands; str() says why."""


class TimedOut(FleetError):
    """The script's own limit has passed. The fleet goes on."""


@dataclass(frozen=True)
class State:
    """One vehicle. m and m/s, world; heading in rad, counter-clockwise from x."""

    name: str
    position: tuple
    velocity: tuple
    heading: float
    tracked: bool  # False: the rest is the last that was seen


def _heading(w, x, y, z):
    return math.atan2(2.0 * (w * z + x * y), 1.0 - 2.0 * (y * y + z * z))


class Fleet:
    """What runs as `fleet`, as seen from a script. One thread at a time.

    url: default LCM_DEFAULT_URL, else LCM's default group on this machine only. Raises FleetLost if no fleet speaks.
    """

    patience_s = 3.0  # of wall clock without a word of the fleet

    def __init__(self, url=None):
        self._lcm = connect(url or os.environ.get("LCM_DEFAULT_URL") or DEFAULT_URL)
        self.status = None  # the last fleet_status_t
        self._states = None  # the last, not decoded
        self._heard_at = time.monotonic()
        self._statuses = 0
        self._last_id = 0
        self._asked = 0  # the last id that is flown
        self._lcm.subscribe("FLEET_STATUS", self._on_status)
        self._lcm.subscribe("VEHICLE_STATES", self._on_states)
        while self.status is None:
            self._listen()

    def __enter__(self):
        return self

    def __exit__(self, *_):
        return False

    # Verbs

    def take_off(self, wait=True, timeout=60.0):
        """Everybody climbs to its height above its place."""
        return self._do("take_off", wait=wait, timeout=timeout)

    def land(self, wait=True, timeout=60.0):
        """Everybody descends where it is, at once; what is queued is dropped."""
        return self._do("land", wait=wait, timeout=timeout)

    def hold(self, wait=False, timeout=60.0):
        """Everybody stays where it is, at once; what is queued is dropped."""
        return self._do("hold", wait=wait, timeout=timeout)

    def wait(self, seconds, wait=True):
        """Nothing changes for so many seconds of data time."""
        return self._do("wait", seconds=seconds, wait=wait, timeout=10.0 * seconds + 60.0)

    def wait_until(self, what, wait=True, timeout=3600.0):
        """Nothing changes until what: "formed", "go_on" (somebody says it), or seconds since the take-off began."""
        if isinstance(what, str):
            return self._do("wait_until", text=what, wait=wait, timeout=timeout)
        return self._do("wait_until", seconds=what, wait=wait, timeout=timeout)

    def go_on(self):
        """Ends a wait_until("go_on"), whoever asked for it."""
        return self._do("go_on", wait=False)

    def spell(self, text, seconds=None, wait=True, timeout=None):
        """Letter by letter, each held for so many seconds (default: the experiment's)."""
        timeout = 120.0 * max(1, len(text)) if timeout is None else timeout
        return self._do("spell", text=text, seconds=seconds, wait=wait, timeout=timeout)

    def formation(self, points, name="formation", seconds=0.0, wait=True, timeout=120.0):
        """A vehicle goes to each point (x, y, z); those left over stay. Held for so many seconds."""
        return self._do("formation", points=points, text=name, seconds=seconds, wait=wait, timeout=timeout)

    def go_to(self, vehicle, point, wait=True, timeout=120.0):
        """One vehicle goes to a point (x, y, z)."""
        return self._do("go_to", points=[point], vehicle=vehicle, wait=wait, timeout=timeout)

    def emergency(self, vehicle=""):
        """Motors off, now: of one vehicle, or of all. Whatever flies falls."""
        self._order(safety_order_t.KILL, vehicle)

    def resume(self, vehicle=""):
        """Lifts what an operator has ordered."""
        self._order(safety_order_t.RESUME, vehicle)

    # Looking

    def states(self):
        """The newest State of every vehicle, by name."""
        frame = None
        while frame is None:
            self._states = None
            while self._states is None:
                self._listen()
            try:
                frame = vehicle_states_t.decode(self._states)
            except Exception:  # damaged: there will be another one
                pass
        return {
            vehicle.name: State(
                vehicle.name,
                tuple(vehicle.position),
                tuple(vehicle.velocity),
                _heading(*vehicle.orientation),
                bool(vehicle.tracked),
            )
            for vehicle in frame.vehicles
        }

    @property
    def phase(self):
        """"idle", "go", "hold" and so on, as the fleet said last."""
        return PHASES[self.status.phase]

    def wait_until_formed(self, mission=None, timeout=120.0):
        """Until the formation (default: what was asked for last) is formed; it may be held for longer."""
        mission = self._asked if mission is None else mission
        self._wait(lambda: self._finished(mission) or self._formed(mission), mission, timeout)

    def wait_until_done(self, mission=None, timeout=120.0):
        """Until a mission (default: what was asked for last) is done."""
        mission = self._asked if mission is None else mission
        self._wait(lambda: self._finished(mission), mission, timeout)

    # Within

    def _on_status(self, _, data):
        try:
            self.status = fleet_status_t.decode(data)
        except Exception:  # damaged: there will be another one
            return
        self._statuses += 1
        self._heard_at = time.monotonic()

    def _on_states(self, _, data):
        self._states = data

    def _listen(self):
        self._lcm.handle(0.05)
        silent_s = time.monotonic() - self._heard_at
        if silent_s > self.patience_s:
            who = "no fleet is heard" if self.status is None else f"the fleet has said nothing for {silent_s:.1f} s"
            raise FleetLost(f"{who}; vehicles stay at their goals")

    def _refusal(self, mission):
        prefix = f"mission {mission}: "
        for line in self.status.refusals:
            if line.startswith(prefix):
                return line[len(prefix):]
        return None

    def _finished(self, mission):
        return self.status.finished_mission_id >= mission

    def _formed(self, mission):
        return self.status.mission_id == mission and self.status.phase == HOLD

    def _check(self, mission):
        refusal = self._refusal(mission)
        if refusal is not None:
            raise Refused(refusal)
        if self.status.phase == FAILED:
            raise MissionFailed(self.status.reason)

    def _wait(self, done, mission, timeout):
        deadline = time.monotonic() + timeout
        while True:
            self._check(mission)
            if done():
                return
            known = self.status.newest_mission_id >= mission
            if not known:
                raise FleetForgot("the fleet was restarted; vehicles stay at their goals")
            if time.monotonic() > deadline:
                raise TimedOut(f"not done within {timeout:.0f} s; the fleet is in phase {self.phase}: {self.status.reason}")
            self._listen()

    def _do(self, verb, points=(), text="", vehicle="", seconds=None, wait=True, timeout=60.0):
        message = mission_t()
        message.utime = int(time.time() * 1e6)
        self._last_id = max(message.utime, self._last_id + 1)
        message.utime = message.mission_id = self._last_id
        message.verb = verb
        message.text = text
        message.vehicle = vehicle
        message.seconds = float("nan") if seconds is None else float(seconds)
        message.points = [[float(value) for value in point] for point in points]
        message.num_points = len(message.points)
        self._lcm.publish("MISSION", message.encode())
        self._wait_until_taken(self._last_id)
        if verb != "go_on":
            self._asked = self._last_id
        if wait:
            self.wait_until_done(self._asked, timeout)
        return self._last_id

    def _wait_until_taken(self, mission):
        deadline = time.monotonic() + self.patience_s
        while self.status.newest_mission_id < mission and self._refusal(mission) is None:
            if time.monotonic() > deadline:
                raise FleetLost("the fleet does not take the mission")
            self._listen()
        refusal = self._refusal(mission)
        if refusal is not None:
            raise Refused(refusal)

    def _order(self, kind, vehicle):
        message = safety_order_t()
        message.utime = int(time.time() * 1e6)
        message.vehicle = vehicle
        message.order = kind
        for _ in range(5):  # planners take a repeated order for one
            self._lcm.publish("SAFETY_ORDER", message.encode())
            time.sleep(0.02)
