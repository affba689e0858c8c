"""LCM over UDP multicast with Python's standard library alone, for machines without the `lcm` package.

The wire format is that of LCM 1.x: https://lcm-proj.github.io/lcm/content/udp-multicast-protocol.html
"""

import select
import socket
import struct
import time
from urllib.parse import parse_qs, urlsplit

SHORT_MAGIC = 0x4C433032
LONG_MAGIC = 0x4C433033
LARGEST_SHORT = 65499  # bytes of channel, terminator and payload in one datagram
FRAGMENT = 65487  # bytes of payload
FRAGMENTS_KEPT = 100  # unfinished messages

DEFAULT_URL = "udpm://239.255.76.67:7667?ttl=0"


class Transport:
    """Publishes and receives whole messages as bytes. One thread at a time."""

    def __init__(self, url):
        parts = urlsplit(url)
        if parts.scheme != "udpm":
            raise ValueError(f"{url}: expected udpm://ADDRESS:PORT?ttl=N")
        group = parts.hostname or "239.255.76.67"
        self._address = (group, parts.port or 7667)
        ttl = int(parse_qs(parts.query).get("ttl", ["0"])[0])
        self._handlers = {}
        self._unfinished = {}
        self._number = 0
        self._socket = socket.socket(socket.AF_INET, socket.SOCK_DGRAM)
        self._socket.setsockopt(socket.SOL_SOCKET, socket.SO_REUSEADDR, 1)
        self._socket.setsockopt(socket.SOL_SOCKET, socket.SO_RCVBUF, 4 << 20)
        self._socket.setsockopt(socket.IPPROTO_IP, socket.IP_MULTICAST_TTL, ttl)
        self._socket.setsockopt(socket.IPPROTO_IP, socket.IP_MULTICAST_LOOP, 1)
        self._socket.bind(("", self._address[1]))
        membership = struct.pack("4sl", socket.inet_aton(group), socket.INADDR_ANY)
        self._socket.setsockopt(socket.IPPROTO_IP, socket.IP_ADD_MEMBERSHIP, membership)
        self._socket.setblocking(False)

    def subscribe(self, channel, handler):
        """handler(channel, bytes) is called within handle(). The channel is a name, no pattern."""
        self._handlers.setdefault(channel, []).append(handler)

    def publish(self, channel, data):
        name = channel.encode() + b"\0"
        self._number = (self._number + 1) & 0xFFFFFFFF
        if len(name) + len(data) <= LARGEST_SHORT:
            header = struct.pack(">II", SHORT_MAGIC, self._number)
            self._socket.sendto(header + name + data, self._address)
            return
        # The first fragment carries the name as well, and that much less of the payload.
        ends = [FRAGMENT - len(name)]
        while ends[-1] < len(data):
            ends.append(ends[-1] + FRAGMENT)
        begin = 0
        for i, end in enumerate(ends):
            header = struct.pack(">IIIIHH", LONG_MAGIC, self._number, len(data), begin, i, len(ends))
            self._socket.sendto(header + (name if i == 0 else b"") + data[begin:end], self._address)
            begin = end

    def handle(self, timeout_s):
        """Waits for a message, at most so long, and handles all that have come. Returns how many."""
        count = 0
        deadline = time.monotonic() + timeout_s
        while True:
            left = max(0.0, deadline - time.monotonic())
            if not select.select([self._socket], [], [], 0.0 if count else left)[0]:
                return count
            datagram, sender = self._socket.recvfrom(65535)
            message = self._message(datagram, sender)
            if message is not None:
                count += 1
                for handler in self._handlers.get(message[0], ()):
                    handler(*message)

    def _message(self, datagram, sender):
        """(channel, payload) once it is complete; None for less, and for what is no LCM."""
        if len(datagram) < 8:
            return None
        magic, number = struct.unpack_from(">II", datagram)
        if magic == SHORT_MAGIC:
            name, found, payload = datagram[8:].partition(b"\0")
            return (name.decode(errors="replace"), payload) if found else None
        if magic != LONG_MAGIC or len(datagram) < 20:
            return None
        size, offset, index, count = struct.unpack_from(">IIHH", datagram, 8)
        parts = self._unfinished.setdefault((sender, number), {"size": size, "parts": {}, "name": None})
        payload = datagram[20:]
        if index == 0:
            name, _, payload = payload.partition(b"\0")
            parts["name"] = name.decode(errors="replace")
        parts["parts"][offset] = payload
        if len(parts["parts"]) < count:
            while len(self._unfinished) > FRAGMENTS_KEPT:
                del self._unfinished[next(iter(self._unfinished))]
            return None
        del self._unfinished[(sender, number)]
        whole = b"".join(part for _, part in sorted(parts["parts"].items()))
        return (parts["name"], whole) if parts["name"] is not None and len(whole) == size else None


class LcmPackage:
    """The same over the `lcm` package, where it is installed."""

    def __init__(self, url, lcm):
        self._lcm = lcm.LCM(url)

    def subscribe(self, channel, handler):
        self._lcm.subscribe(channel, handler)

    def publish(self, channel, data):
        self._lcm.publish(channel, data)

    def handle(self, timeout_s):
        count = 0
        while self._lcm.handle_timeout(0 if count else max(0, int(timeout_s * 1000))) > 0:
            count += 1
        return count


def connect(url):
    """A transport by the `lcm` package if it is there, else by the one of this file."""
    try:
        import lcm
    except ImportError:
        return Transport(url)
    return LcmPackage(url, lcm)
