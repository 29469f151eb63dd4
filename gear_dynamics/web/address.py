"""What is said of the address that the page is served on."""

from __future__ import annotations

import contextlib
import ipaddress
import os

from gear_dynamics.parameters.settings import DashboardSettings
from gear_dynamics.web.server import PageServer


def lines_of_address(settings: DashboardSettings, server: PageServer) -> list[str]:
    """Return the lines that tell where the page is, and whether others can reach it."""
    lines = [f'the page is at {server.address}']
    if not _is_loopback(settings.address):
        lines.append(
            f'it listens on {settings.address}: other machines can see it and command the rig'
        )
    return lines


def cannot_listen(settings: DashboardSettings, error: OSError) -> str:
    """Return the one line that says why the address cannot be listened on."""
    reason = os.strerror(error.errno) if error.errno and error.errno > 0 else str(error)
    return (
        f'cannot listen on {settings.address} port {settings.port}: {reason}; '
        'take another port, or port 0 for a free one'
    )


def _is_loopback(host: str) -> bool:
    if host == 'localhost':
        return True
    with contextlib.suppress(ValueError):
        return ipaddress.ip_address(host).is_loopback
    return False
