# SPDX-License-Identifier: GPL-3.0-or-later
"""How much memory a process has needed."""

from __future__ import annotations

from pathlib import Path


def peak_bytes() -> int:
    """The most that this process has held. Not getrusage's: that one also remembers the process that started it."""
    status = Path("/proc/self/status").read_text(encoding="ascii")
    kibibytes = next(line.split()[1] for line in status.splitlines() if line.startswith("VmHWM:"))
    return 1024 * int(kibibytes)
