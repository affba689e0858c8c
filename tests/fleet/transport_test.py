"""Python's own transport against liblcm (through lcm-logger and lcm-logplayer): transport_test.py MODULES"""

import os
import subprocess
import sys
import tempfile
import time

sys.path.insert(0, sys.argv[1])
from roundabout.transport import Transport

# A port of its own, as tests/support/lcm_url.h gives them out.
url = f"udpm://239.255.76.67:{10000 + os.getpid() % 20000}?ttl=0&recv_buf_size=2000000"
folder = tempfile.TemporaryDirectory()
log = os.path.join(folder.name, "transport.lcm")
payloads = [bytes([size % 251]) * size for size in (0, 1, 100, 65480, 65499, 65500, 150000, 200000)]



def wait_until(what, is_so):
    deadline = time.monotonic() + 20.0
    while not is_so():
        assert time.monotonic() < deadline, what
        time.sleep(0.05)


def logged():
    return os.path.getsize(log) if os.path.exists(log) else 0


logger = subprocess.Popen(["lcm-logger", "-q", "--flush-interval=50", "-f", "--lcm-url=" + url, log])
sender = Transport(url)


def logged_with_a_nudge():
    """lcm-logger writes out what it has when more comes."""
    sender.publish("NUDGE", b"")
    return logged()


wait_until("lcm-logger listens", lambda: logged_with_a_nudge() > 0)
for payload in payloads:
    before = logged()
    sender.publish("TRANSPORT_TEST", payload)
    wait_until(f"{len(payload)} bytes are in the log", lambda: logged_with_a_nudge() > before + len(payload))
logger.terminate()
logger.wait()

heard = []
receiver = Transport(url)
receiver.subscribe("TRANSPORT_TEST", lambda channel, data: heard.append(data))
player = subprocess.Popen(["lcm-logplayer", "--lcm-url=" + url, log], stdout=subprocess.DEVNULL)
deadline = time.monotonic() + 30.0
while len(heard) < len(payloads) and time.monotonic() < deadline:
    receiver.handle(0.1)
player.wait()
assert [len(data) for data in heard] == [len(data) for data in payloads], [len(data) for data in heard]
assert heard == payloads
print("every message came through, both ways")
