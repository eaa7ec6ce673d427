# SPDX-License-Identifier: GPL-3.0-or-later
"""A picture in which every part of the add-on has worked, threads too, and out again by Python's own way."""

import harness
import pictures

harness.open_plume()
assert pictures.render((64, 36))[..., :3].max() > 0.1
