# SPDX-License-Identifier: GPL-3.0-or-later
"""What draws and computes on the GPU; only here is `gpu` imported."""
