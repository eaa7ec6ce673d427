# SPDX-License-Identifier: GPL-3.0-or-later
"""The add-on is there."""

import addon_utils
import harness


def test_addon_is_enabled() -> None:
    assert addon_utils.check(harness.ADDON)[1]


harness.main()
