"""Figures of the process as text for Prometheus, on loopback (extra `fleet`). Off unless a port is given.

The loop notes its figures once a second; the thread that answers reads only what was noted.
"""

from __future__ import annotations

import time
from collections.abc import Iterator, Mapping
from typing import Any

from safeloc.errors import InputError
from safeloc.runtime.service.address import Address

_EVERY_S = 1.0
_BOUNDS_S = (0.001, 0.002, 0.005, 0.01, 0.02, 0.05, 0.1, 0.2, 0.5, 1.0, 2.0, 5.0)
_GAUGES = {
    "vehicles": "vehicles of the process",
    "localized": "vehicles whose last report has a position",
    "partitions": "partitions of the fleet that the process owns",
}
_COUNTERS = {
    "lines": "lines read",
    "refused": "lines refused",
    "cycles": "cycles reported",
    "rejections": "records not used",
    "breaches": "breaches of assumptions",
    "failed": "unexpected exceptions in the handling of a vehicle",
    "repeated": "lines that came again and were left out",
    "wrong": "reports whose interval did not contain the true position",
}


class Metrics:
    """The figures, and the server that shows them."""

    def __init__(self, where: Address) -> None:
        client = load_prometheus()
        self._family = client.core
        self._latest: Mapping[str, int] = {}
        self._noted_at = 0.0
        registry = client.CollectorRegistry()
        told = "seconds from the arrival of a cycle's first line to its report"
        self.observe = client.Histogram("safeloc_cycle_seconds", told, registry=registry, buckets=_BOUNDS_S).observe
        registry.register(self)
        try:
            self._server, _thread = client.start_http_server(where.port, where.host, registry)
        except OSError as error:
            raise InputError(f"port {where.port} of {where.host} is not available: {error.strerror}.") from error

    @property
    def port(self) -> int:
        """Return the port on which it answers."""
        return int(self._server.server_port)

    def due(self) -> bool:
        """Return whether the figures are to be noted again."""
        return time.monotonic() >= self._noted_at + _EVERY_S

    def note(self, figures: Mapping[str, int]) -> None:
        """Note the figures as of now."""
        self._latest, self._noted_at = dict(figures), time.monotonic()

    def collect(self) -> Iterator[Any]:
        """Yield what was noted last, for prometheus-client."""
        latest = self._latest
        for name, told in _GAUGES.items():
            if name in latest:
                yield self._family.GaugeMetricFamily(f"safeloc_{name}", told, latest[name])
        for name, told in _COUNTERS.items():
            if name in latest:
                yield self._family.CounterMetricFamily(f"safeloc_{name}", told, latest[name])

    def close(self) -> None:
        """Answer no more."""
        self._server.shutdown()
        self._server.server_close()


def load_prometheus() -> Any:
    """Return prometheus_client; InputError where it is not installed."""
    try:
        import prometheus_client
        import prometheus_client.core
    except ImportError as error:
        raise InputError("--metrics needs prometheus-client; install safeloc[fleet].") from error
    return prometheus_client
