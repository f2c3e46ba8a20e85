# SPDX-License-Identifier: Apache-2.0
"""A connection that is as slow as it is told to be, between a browser and a studio.

    slow_link.py STUDIO_PORT

Prints the port at which it listens. Each line of its standard input is the number of bytes that pass from the studio to the
browser in a second from then on, of all connections together: "0": none, "all": as many as come. It ends with its input.
What the system keeps between the studio and here is bounded, as on a slow network: the studio notices soon who is slow.
"""
import socket
import sys
import threading
import time

CHUNK = 8192
RECEIVE_BUFFER = 16384


class Rate:
    """How many bytes may pass."""

    def __init__(self):
        self._changed = threading.Condition()
        self._per_second = None
        self._due = 0.0  # when the next bytes may pass

    def set(self, per_second):
        with self._changed:
            self._per_second = per_second
            self._due = time.monotonic()
            self._changed.notify_all()

    def wait(self, count):
        """Until so many bytes may pass."""
        with self._changed:
            while self._per_second is not None:
                left = self._due - time.monotonic()
                if self._per_second > 0 and left <= 0:
                    self._due = max(self._due, time.monotonic() - 0.1) + count / self._per_second
                    return
                self._changed.wait(left if self._per_second > 0 else None)


def carry(source, sink, rate=None):
    try:
        while data := source.recv(CHUNK):
            if rate:
                rate.wait(len(data))
            sink.sendall(data)
    except OSError:
        pass  # one side has ended, and so does the other
    for one in (source, sink):
        try:
            one.shutdown(socket.SHUT_RDWR)
        except OSError:
            pass


def main():
    rate = Rate()
    studio_port = int(sys.argv[1])
    listener = socket.create_server(("127.0.0.1", 0))
    print(listener.getsockname()[1], flush=True)

    def accept():
        while True:
            browser, _ = listener.accept()
            studio = socket.socket()
            # Before it connects, so that no more is ever promised to the studio.
            studio.setsockopt(socket.SOL_SOCKET, socket.SO_RCVBUF, RECEIVE_BUFFER)
            try:
                studio.connect(("127.0.0.1", studio_port))
            except OSError:  # it has ended
                browser.close()
                continue
            for one in (browser, studio):
                one.setsockopt(socket.IPPROTO_TCP, socket.TCP_NODELAY, 1)
            threading.Thread(target=carry, args=(studio, browser, rate), daemon=True).start()
            threading.Thread(target=carry, args=(browser, studio), daemon=True).start()

    threading.Thread(target=accept, daemon=True).start()
    for line in sys.stdin:
        rate.set(None if line.strip() == "all" else float(line))


main()
