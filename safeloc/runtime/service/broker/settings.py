"""Settings of a broker and credentials for it: from the address, a file and the environment, never from the command line."""

from __future__ import annotations

import ipaddress
import os
import re
import ssl
import tomllib
from collections.abc import Mapping
from dataclasses import dataclass, field
from pathlib import Path

from pydantic import BaseModel, ConfigDict, Field, ValidationError

from safeloc.errors import InputError
from safeloc.runtime.outside import quoted
from safeloc.runtime.service.broker.codes import Codes
from safeloc.runtime.service.broker.topics import PREFIX
from safeloc.runtime.toml_place import line_of

_PASSWORD = "SAFELOC_BROKER_PASSWORD"
"""Environment variable with the password, if no file has it."""

_SCHEMES = {"mqtt": 1883, "mqtts": 8883}
_ADDRESS = re.compile(r"(\[[0-9A-Fa-f:.]+\]|[A-Za-z0-9.-]+)(?::([0-9]{1,5}))?/(.+)")
_MOST_BYTES = 65_536


class BrokerFile(BaseModel):
    """The file of `--broker`.

    partitions        parts into which the fleet is divided; the same for vehicles and for all processes
    lease_ms          silence after which the partition of a process may be taken by another one
    gather_ms         least time from one turn of a process to the next; what comes meanwhile is handled at once, which takes
                      it a fraction of the time
    user              name for the broker
    password_file     file with the password, and nothing else
    authority_file    certificates that may vouch for the broker; without it, those of the system
    certificate_file  own certificate, if the broker asks for one
    key_file          its key
    code_key_file     file with the secret key, of at least 32 bytes, of the code that each report gets
    """

    model_config = ConfigDict(strict=True, extra="forbid", frozen=True)

    partitions: int = Field(default=16, ge=1, le=1_024)
    lease_ms: int = Field(default=5_000, ge=500, le=600_000)
    gather_ms: int = Field(default=5, ge=0, le=100)
    user: str | None = Field(default=None, min_length=1, max_length=1_000)
    password_file: str | None = None
    authority_file: str | None = None
    certificate_file: str | None = None
    key_file: str | None = None
    code_key_file: str | None = None


@dataclass(frozen=True)
class Broker:
    """A broker, and how to log in."""

    host: str
    port: int
    prefix: str
    partitions: int
    lease_s: float
    user: str | None = None
    password: str | None = field(default=None, repr=False)
    tls: ssl.SSLContext | None = None
    codes: Codes | None = field(default=None, repr=False)
    gather_s: float = 0.0


def is_broker(source: str) -> bool:
    """Return whether `--from` names a broker."""
    return source.partition("://")[0] in _SCHEMES


def read_broker(url: str, path: Path | None, environment: Mapping[str, str] = os.environ) -> Broker:
    """Return the broker of `mqtt://HOST:PORT/PREFIX` or `mqtts://...`, with the settings of a file.

    InputError for a wrong address or setting, for a password in the address, and for a broker on another computer without
    TLS.
    """
    scheme, _, rest = url.partition("://")
    if "@" in rest:
        raise InputError(
            "an address with a user or a password; put them into the file of --broker, or the environment."
        )
    found = _ADDRESS.fullmatch(rest)
    if scheme not in _SCHEMES or found is None or PREFIX.fullmatch(found[3]) is None:
        raise InputError(
            f"{quoted(url)} is no broker; give mqtts://HOST:PORT/PREFIX, for instance mqtts://broker/fleet."
        )
    host, port = found[1].strip("[]"), int(found[2] or _SCHEMES[scheme])
    if not 0 < port < 65_536:
        raise InputError(f"{port} is no port; give a number from 1 to 65535.")
    if scheme == "mqtt" and not _is_here(host):
        raise InputError(f"{host} is not on this computer; without TLS only loopback is allowed: give mqtts://.")
    file = BrokerFile() if path is None else _read(path)
    folder = Path() if path is None else path.parent
    tls = _tls(file, folder) if scheme == "mqtts" else None
    password = _password(file, folder, environment)
    return Broker(
        host, port, found[3], file.partitions, file.lease_ms / 1_000, file.user, password, tls, _codes(file, folder),
        file.gather_ms / 1_000,
    )  # fmt: skip


def _is_here(host: str) -> bool:
    try:
        return host == "localhost" or ipaddress.ip_address(host).is_loopback
    except ValueError:
        return False


def _read(path: Path) -> BrokerFile:
    text = _text(path)
    try:
        return BrokerFile.model_validate(tomllib.loads(text))
    except (tomllib.TOMLDecodeError, RecursionError) as error:
        raise InputError(f"{path}: not TOML: {error}.") from error
    except ValidationError as error:
        first = error.errors(include_url=False, include_input=False, include_context=False)[0]
        line, key = line_of(text, first["loc"]), ".".join(map(str, first["loc"]))
        raise InputError(f"{path}:{line}: {key}: {first['msg']}.") from error


def _password(file: BrokerFile, folder: Path, environment: Mapping[str, str]) -> str | None:
    if file.password_file is not None:
        found = _text(folder / file.password_file).strip("\r\n")
    else:
        found = environment.get(_PASSWORD, "")
    if found and file.user is None:
        raise InputError("a password without a user; give `user` in the file of --broker.")
    return found or None


def _codes(file: BrokerFile, folder: Path) -> Codes | None:
    if file.code_key_file is None:
        return None
    path = folder / file.code_key_file
    try:
        return Codes(_bytes(path))
    except ValueError as error:
        raise InputError(f"{path}: {error}.") from error


def _tls(file: BrokerFile, folder: Path) -> ssl.SSLContext:
    """Return TLS 1.3 that knows the broker by its name; InputError for a file that cannot be used."""
    own = (file.certificate_file, file.key_file)
    if (own[0] is None) is not (own[1] is None):
        raise InputError("certificate_file and key_file belong together; give both in the file of --broker.")
    authority = None if file.authority_file is None else folder / file.authority_file
    try:
        context = ssl.create_default_context(cafile=authority)
        context.minimum_version = ssl.TLSVersion.TLSv1_3
        if own[0] is not None and own[1] is not None:
            context.load_cert_chain(folder / own[0], folder / own[1], password=_refused)
    except OSError as error:  # ssl.SSLError among them
        named = ", ".join(str(one) for one in (file.authority_file, *own) if one is not None)
        raise InputError(f"{named}: no certificate or key that can be used: {error.strerror or error}.") from error
    return context


def _refused() -> str:
    raise InputError("the key is encrypted; give one without a pass phrase, readable by this process only.")


def _text(path: Path) -> str:
    try:
        return _bytes(path).decode()
    except UnicodeDecodeError as error:
        raise InputError(f"{path}: not UTF-8.") from error


def _bytes(path: Path) -> bytes:
    try:
        with path.open("rb") as file:
            data = file.read(_MOST_BYTES + 1)
    except OSError as error:
        raise InputError(f"{path}: cannot be read: {error.strerror}.") from error
    if len(data) > _MOST_BYTES:
        raise InputError(f"{path}: longer than {_MOST_BYTES} bytes.")
    return data
