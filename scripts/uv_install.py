#!/usr/bin/env python3
"""Runs `uv pip install` for the interpreter that runs this, with the settings that pip has.

    python scripts/uv_install.py UV SETTINGS ARGUMENT...

UV is the program, SETTINGS a file of what `pip config list` printed. uv reads neither pip's files nor its variables:
each setting is told uv by the variable of the same meaning. Where there is none, a line says so, and the exit status
is 3.
"""

from __future__ import annotations

import ast
import os
import re
import ssl
import subprocess
import sys
from collections.abc import Mapping, Sequence
from pathlib import Path

UNTOLD = 3  # exit status: uv cannot be told one of pip's settings
SECTIONS = ("global", "install", ":env:")  # of `pip install`; the later overrides the earlier
VALUES = {"index-url": "UV_DEFAULT_INDEX", "retries": "UV_HTTP_RETRIES"}
LISTS = {"extra-index-url": ("UV_INDEX", " "), "trusted-host": ("UV_INSECURE_HOST", " ")}
TRUE = {"1", "on", "t", "true", "y", "yes"}
ELSEWHERE = {"cert", "client-cert", "no-index"}  # told by certificates() and main()
KEPT = ("UV_CACHE_DIR", "UV_CONCURRENT_", "UV_LINK_MODE", "UV_NO_CACHE")  # of uv's own variables: how, not from where
NO_MATTER = {  # for pinned wheels in a virtual environment of their own; or about what pip prints and keeps
    "break-system-packages", "cache-dir", "compile", "config-file", "disable-pip-version-check", "exists-action", "log",
    "no-color", "no-compile", "no-deps", "no-input", "no-python-version-warning", "no-warn-script-location",
    "only-binary", "prefer-binary", "progress-bar", "quiet", "require-hashes", "require-virtualenv",
    "root-user-action", "upgrade", "upgrade-strategy", "use-deprecated", "use-feature", "verbose"}


class UntoldError(Exception):
    """One of pip's settings means nothing to uv."""


def settings(listed: str) -> dict[str, str]:
    """The options of `pip install` by name, from what `pip config list` printed.

    Raises UntoldError where two files give one option different values: the list does not tell which file counts.
    """
    found = {}
    for section, name, value in re.findall(r"^([\w:-]+)\.([\w-]+)=(.*)$", listed, flags=re.MULTILINE):
        option = section, name.replace("_", "-")
        if found.setdefault(option, value) != value:
            raise UntoldError(f"{section}.{name}: several files of pip's set it")
    return {name: str(ast.literal_eval(value)) for wanted in SECTIONS
            for (section, name), value in found.items() if section == wanted}


def certificates(options: Mapping[str, str], environment: Mapping[str, str]) -> dict[str, str]:
    """The variables for the certificates that pip trusts: those it is told, the system's, or where it has none uv's.

    Raises UntoldError where one is not there: pip then stops, and uv would take its own.
    """
    client = options.get("client-cert")
    bundle = options.get("cert") or environment.get("REQUESTS_CA_BUNDLE") or environment.get("CURL_CA_BUNDLE")
    for path in filter(None, (client, bundle)):
        if not Path(path).exists():
            raise UntoldError(f"{path}: there is no such file of certificates")
    every = {"SSL_CLIENT_CERT": client} if client else {}
    if bundle:
        return every | {"SSL_CERT_DIR" if Path(bundle).is_dir() else "SSL_CERT_FILE": bundle}
    system = ssl.get_default_verify_paths()
    has_some = system.cafile or (system.capath and os.listdir(system.capath))
    return every | ({"UV_SYSTEM_CERTS": "1"} if has_some else {})


def _constraint(value: str, pinned: set[str]) -> dict[str, str]:
    """Nothing, where the files of constraints name none of the packages that are pinned anyway; else UntoldError."""
    for file in value.split():
        try:
            lines = Path(file.removeprefix("file://")).read_text().splitlines()
        except OSError:
            raise UntoldError(f"constraint {file}: cannot be read") from None
        names = {re.match(r"\s*([\w.-]*)", line)[1] for line in lines if not re.match(r"\s*(#|$)", line)}
        plain = {re.sub(r"[-_.]+", "-", name).lower() for name in names}
        if not all(re.match(r"\w", name) for name in names) or plain & pinned:
            raise UntoldError(f"constraint {file}: it may concern what is installed")
    return {}


def _find_links(value: str) -> dict[str, str]:
    """The places, but for folders that are not there, which pip passes over and uv does not."""
    places = [place for place in value.split() if re.match(r"\w+:", place) or Path(place).exists()]
    return {"UV_FIND_LINKS": ",".join(places)} if places else {}


def _proxy(value: str) -> dict[str, str]:
    return dict.fromkeys(("HTTP_PROXY", "HTTPS_PROXY"), value if "://" in value else f"http://{value}")


def told(name: str, value: str, pinned: set[str]) -> dict[str, str]:
    """The variables that tell uv one option of pip's. Raises UntoldError where there are none."""
    if not value or name in NO_MATTER | ELSEWHERE:
        return {}
    if name in VALUES:
        return {VALUES[name]: value}
    if name in LISTS:
        variable, separator = LISTS[name]
        return {variable: separator.join(value.split())}
    if name == "no-cache-dir":
        return {"UV_NO_CACHE": "1"} if value.lower() in TRUE else {}
    if name in {"timeout", "default-timeout"}:
        return {"UV_HTTP_TIMEOUT": str(round(float(value)))}
    of_one = {"constraint": lambda: _constraint(value, pinned), "find-links": lambda: _find_links(value),
              "proxy": lambda: _proxy(value)}
    if name not in of_one:
        raise UntoldError(f"{name}: uv has none like it")
    return of_one[name]()


def variables(options: Mapping[str, str], pinned: set[str], environment: Mapping[str, str]) -> dict[str, str]:
    """What uv is told when it installs the packages `pinned`, given pip's options. Raises UntoldError."""
    every = {"UV_NO_CONFIG": "1",  # where packages come from is for pip's settings alone to say
             "UV_INDEX_STRATEGY": "unsafe-best-match"}  # of all indexes, as pip does: hashes say what is the same
    every |= certificates(options, environment)
    for name, value in options.items():
        every |= told(name, value, pinned)
    return every


def pinned_in(arguments: Sequence[str]) -> set[str]:
    """The packages that the files after -r name."""
    files = [arguments[i + 1] for i, argument in enumerate(arguments) if argument == "-r"]
    return {name for file in files for name in re.findall(r"^([a-z0-9-]+)==", Path(file).read_text(), re.MULTILINE)}


def without_cache(uv: str) -> dict[str, str]:
    """What tells uv to keep nothing, where it cannot write where it keeps wheels, as in a read-only home."""
    place = subprocess.run([uv, "cache", "dir"], capture_output=True, text=True, check=False).stdout.strip()
    try:
        os.makedirs(place, exist_ok=True)
        writable = os.access(place, os.W_OK)
    except OSError:
        writable = False
    return {} if writable else {"UV_NO_CACHE": "1"}


def environment_of_uv(inherited: Mapping[str, str], told: Mapping[str, str]) -> dict[str, str]:
    """What uv inherits, less what would send it elsewhere than pip or have it trust more certificates, and `told`."""
    bundle = {"SSL_CERT_DIR", "SSL_CERT_FILE"}
    dropped = bundle if bundle & told.keys() else set()
    return {name: value for name, value in inherited.items()
            if name not in dropped and (not name.startswith("UV_") or name.startswith(KEPT))} | dict(told)


def main(uv: str, listed: str, *arguments: str) -> None:
    """Becomes uv."""
    try:
        options = settings(Path(listed).read_text())
        extra = variables(options, pinned_in(arguments), os.environ)
    except (UntoldError, ValueError, OverflowError) as error:
        print(f"pip's setting {error}", file=sys.stderr)
        sys.exit(UNTOLD)
    no_index = ["--no-index"] if options.get("no-index", "").lower() in TRUE else []  # the one without a variable
    command = [uv, "pip", "install", "--quiet", "--python", sys.executable, *no_index, *arguments]
    os.execve(uv, command, environment_of_uv(os.environ, without_cache(uv) | extra))  # noqa: S606


if __name__ == "__main__":
    main(*sys.argv[1:])
