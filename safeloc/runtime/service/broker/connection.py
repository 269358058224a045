"""One connection to the broker, in the loop of the process: paho-mqtt without its threads (extra `fleet`).

MQTT 3.1.1: reading a message of MQTT 5 takes paho four times as long, and nothing of version 5 is needed. Message expiry
counts by the broker's clock, and the last word about who owns a partition is the session in both versions.

Over a lasting connection records, reports and acknowledgements go past paho (`packets`); it has all other packets, in their
order among these, and each second one record, so that it hears that the broker is there.
"""

from __future__ import annotations

import selectors
import time
from collections import deque
from collections.abc import Iterator
from typing import TYPE_CHECKING, Any

from safeloc.errors import InputError
from safeloc.runtime.service.broker.buffered import BufferedSocket
from safeloc.runtime.service.broker.packets import LONGEST, Came, acknowledgement, publish, read_publish
from safeloc.runtime.service.broker.settings import Broker
from safeloc.runtime.service.feeds import Event

if TYPE_CHECKING:
    from paho.mqtt.client import Client, ConnectFlags, DisconnectFlags, MQTTMessage
    from paho.mqtt.properties import Properties
    from paho.mqtt.reasoncodes import ReasonCode

_KEEP_ALIVE_S = 5
"""Seconds after which the broker is asked whether it is there; it publishes the last will after one and a half of them."""

_CONNECT_S = 2.0
"""Most seconds for the TCP connection; meanwhile the loop stands still."""

_MISC_S = 1.0
"""Seconds between two looks at what is due without data: a ping, or a broker that does not answer."""


class Connection:
    """A connection, or the attempt at one.

    session   its name at the broker; whoever connects with the same name later ends this connection
    lasting   the session outlives the connection: what comes meanwhile waits, and what was not acknowledged comes again
    will      topic and payload of what the broker publishes (retained) if the connection breaks
    ready     the broker has accepted it
    resumed   the broker had kept the session
    lost      why there is no connection any more; "" as long as there is one
    """

    def __init__(self, broker: Broker, session: str, will: tuple[str, bytes], *, lasting: bool) -> None:
        self.ready = self.resumed = False
        self.lost = ""
        self.came: deque[Came] = deque()
        self._broker, self._lasting = broker, lasting
        self._client = self._made(session, will)
        self._selector: selectors.BaseSelector | None = None
        self._sock: BufferedSocket | None = None
        self._mask = 0
        self._looked = 0.0
        self._paho_hears = True

    def open(self, selector: selectors.BaseSelector) -> None:
        """Connect; `lost` says why if that is impossible. It is usable when it is `ready`."""
        self._selector = selector
        try:
            self._client.connect(self._broker.host, self._broker.port, _KEEP_ALIVE_S)
        except (OSError, ValueError) as error:  # ssl.SSLError among them, as a certificate that does not fit
            self.lost = f"no connection: {error}"
            return
        if self._sock is None:
            raise InputError(
                "this version of paho-mqtt makes its socket in a way that is not known; install paho-mqtt<3."
            )
        self._attend()

    def subscribe(self, topic: str) -> None:
        """Ask for the messages of a topic, each at least once."""
        self._client.subscribe(topic, 1)

    def publish(self, topic: str, payload: bytes, *, qos: int = 0, retained: bool = False) -> Any:
        """Publish a message; with QoS 1 ask `is_published` of what is returned. Nothing leaves before `flush`."""
        if qos or not self._lasting or len(payload) > LONGEST:
            return self._client.publish(topic, payload, qos, retained)
        return self._put(publish(topic, payload, retained=retained))

    def acknowledge(self, mid: int) -> None:
        """Tell the broker that it may forget a message."""
        self._put(acknowledgement(mid))

    def _put(self, packet: bytes) -> None:
        """Add a packet, behind those that paho has made."""
        if self._client.want_write():
            self._client.loop_write()
        if self._sock is not None:
            self._sock.send(packet)

    @property
    def waiting(self) -> bool:
        """Return whether something is to be sent."""
        return not self.lost and self._sock is not None and (self._client.want_write() or bool(self._sock.unsent))

    def flush(self) -> None:
        """Send as much as the broker takes now; the selector reports when it takes the rest."""
        if not self.waiting or self._sock is None:
            return
        self._client.loop_write()
        if not self.lost:
            self._send(self._sock)
        self._attend()

    def _send(self, sock: BufferedSocket) -> None:
        try:
            sock.flush()
        except OSError as error:
            self.lost = f"the connection ended: {error}"

    def look(self) -> None:
        """Do what is due without data from the broker."""
        now = time.monotonic()
        if not self.lost and self._sock is not None and now >= self._looked + _MISC_S:
            self._looked, self._paho_hears = now, False
            self._client.loop_misc()
            self.flush()

    def close(self, *, politely: bool) -> None:
        """End the connection; politely: without the last will."""
        sock = self._sock
        if sock is not None and politely and self.ready and not self.lost:
            sock.polite = True
            self._client.disconnect()
            self._client.loop_write()
        self.lost = self.lost or "closed"
        self._forget_socket()
        if sock is not None:
            sock.close()

    # ------------------------------------------------------------------ paho

    def _made(self, session: str, will: tuple[str, bytes]) -> Client:
        mqtt = load_paho()
        client: Client = self._buffered(mqtt.Client)(
            mqtt.CallbackAPIVersion.VERSION2, session, clean_session=not self._lasting, protocol=mqtt.MQTTv311,
            reconnect_on_failure=False, manual_ack=self._lasting,
        )  # fmt: skip
        client.connect_timeout = _CONNECT_S
        client.max_inflight_messages_set(0)  # no bound: a lease must not wait for what was sent before
        client.will_set(*will, qos=1, retain=True)
        client.on_connect, client.on_disconnect, client.on_message = self._connected, self._disconnected, self._arrived
        client.on_socket_register_write = lambda *_: None  # packets wait for `flush`
        client.on_socket_close = self._forget_socket
        if self._broker.user is not None:
            client.username_pw_set(self._broker.user, self._broker.password)
        if self._broker.tls is not None:
            client.tls_set_context(self._broker.tls)
        return client

    def _buffered(self, client: Any) -> Any:
        """Return the class of clients whose socket is a BufferedSocket."""
        connection = self

        class Buffered(client):  # type: ignore[misc]
            """A client of paho-mqtt that reads and sends through buffers."""

            def _create_socket(self) -> BufferedSocket:
                take = connection._take if connection._lasting else None
                connection._sock = BufferedSocket(super()._create_socket(), take)
                return connection._sock

        return Buffered

    def _connected(
        self, _client: Client, _data: Any, flags: ConnectFlags, code: ReasonCode, _properties: Properties | None
    ) -> None:
        if code.is_failure:
            self.lost = f"the broker refuses the connection: {code}"
        else:
            self.ready, self.resumed = True, flags.session_present

    def _disconnected(
        self, _client: Client, _data: Any, _flags: DisconnectFlags, code: ReasonCode, _properties: Properties | None
    ) -> None:
        self.lost = self.lost or f"the connection ended: {code}"

    def _arrived(self, _client: Client, _data: Any, message: MQTTMessage) -> None:
        mid = message.mid if message.qos else 0
        try:
            topic = message.topic
        except UnicodeDecodeError:
            topic = ""  # no topic of ours
        self.came.append(Came(topic, bytes(message.payload), mid, message.retain, message.dup))

    def _take(self, first: int, data: bytes, begin: int, end: int) -> bool:
        """Take a message; return whether paho need not see this packet."""
        if not self._paho_hears:
            self._paho_hears = True
            return False
        came = read_publish(first, data, begin, end)
        if came is not None:
            self.came.append(came)
        return came is not None

    # ------------------------------------------------------------------ the selector

    def _ready(self, mask: int) -> Iterator[Event]:
        """Read and write; what comes waits in `came`."""
        if mask & selectors.EVENT_READ:
            self._read()
        if mask & selectors.EVENT_WRITE:
            self.flush()
        self._attend()
        yield from ()

    def _read(self) -> None:
        """Read one piece, or what TLS has decrypted besides, and take all packets in it."""
        sock = self._sock
        while sock is not None and sock.fill():
            while not self.lost and sock.sift():
                self._client.loop_read()
            if self.lost or not sock.decrypted:
                return

    def _attend(self) -> None:
        """Update the selector: the socket is read always, and written to while something waits."""
        if self._selector is None or self._sock is None:
            return
        mask = selectors.EVENT_READ | (selectors.EVENT_WRITE if self.waiting else 0)
        if self._mask == 0:
            self._selector.register(self._sock, mask, self._ready)
        elif mask != self._mask:
            self._selector.modify(self._sock, mask, self._ready)
        self._mask = mask

    def _forget_socket(self, *_: Any) -> None:
        """Forget the socket, before it is closed."""
        if self._selector is not None and self._sock is not None and self._mask:
            self._selector.unregister(self._sock)
        self._mask, self._sock = 0, None


def load_paho() -> Any:
    """Return the client of paho-mqtt; InputError where it is not installed."""
    try:
        from paho.mqtt import client
    except ImportError as error:
        raise InputError("a broker needs paho-mqtt; install safeloc[fleet].") from error
    return client
