"""Where Python has the `lcm` package, scripts speak through it: lcm_package_test.py MODULES

Debian has no such package, so a stand-in with the same calls (lcm.LCM of LCM 1.3 to 1.5) speaks for it here.
"""

import os
import sys
import tempfile
import threading

sys.path.insert(0, sys.argv[1])
from roundabout import transport

STAND_IN = '''
from roundabout.transport import Transport

made = []


class LCM:
    def __init__(self, url=""):
        self.transport, self.waiting, self.handlers = Transport(url), [], {}
        made.append(url)

    def subscribe(self, channel, handler):
        self.handlers[channel] = handler
        self.transport.subscribe(channel, lambda name, data: self.waiting.append((name, data)))

    def publish(self, channel, data):
        assert isinstance(channel, str) and isinstance(data, bytes)
        self.transport.publish(channel, data)

    def handle_timeout(self, milliseconds):
        """One message at most; positive if there was one, 0 if the time passed."""
        assert isinstance(milliseconds, int) and milliseconds >= 0
        if not self.waiting:
            self.transport.handle(milliseconds / 1000.0)
        if not self.waiting:
            return 0
        channel, data = self.waiting.pop(0)
        self.handlers[channel](channel, data)
        return 1
'''



def be_a_fleet(wire, over):
    """Does at once whatever it is asked for, but spell."""
    from roundabout import fleet_status_t, mission_t

    status = fleet_status_t()
    status.phase = 1

    def answer(_, data):
        asked = mission_t.decode(data)
        status.newest_mission_id = asked.mission_id
        if asked.verb == "spell":
            status.refusals = [f"mission {asked.mission_id}: no strokes for {asked.text}"]
            status.num_refusals = 1
        else:
            status.finished_mission_id = asked.mission_id

    wire.subscribe("MISSION", answer)
    while not over.is_set():
        wire.handle(0.05)
        wire.publish("FLEET_STATUS", status.encode())


url = f"udpm://239.255.76.67:{10000 + os.getpid() % 20000}?ttl=0"
assert isinstance(transport.connect(url), transport.Transport), "without the package: the own transport"
with tempfile.TemporaryDirectory() as folder:
    with open(os.path.join(folder, "lcm.py"), "w") as module:
        module.write(STAND_IN)
    sys.path.insert(0, folder)
    import lcm

    from roundabout import Fleet, FleetLost, Refused

    try:
        Fleet.patience_s = 0.3
        Fleet(url)
        raise SystemExit("a fleet that says nothing was found")
    except FleetLost as lost:
        print("without a fleet:", lost)

    Fleet.patience_s = 3.0
    over = threading.Event()
    threading.Thread(target=be_a_fleet, args=(transport.Transport(url), over), daemon=True).start()
    fleet = Fleet(url)
    assert lcm.made == [url, url], lcm.made
    assert isinstance(fleet._lcm, transport.LcmPackage)
    fleet.take_off()
    try:
        fleet.spell("\u00e9")
        raise SystemExit("the refusal was lost")
    except Refused as refused:
        print("refused:", refused)
    over.set()
print("scripts speak through the lcm package")
