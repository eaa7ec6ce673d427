# SPDX-License-Identifier: GPL-3.0-or-later
"""The add-on is there, and answers from the console."""

import pydoc

import addon_utils
import harness
import sfumato


def test_addon_is_enabled() -> None:
    assert addon_utils.check(harness.ADDON)[1]


def test_the_console_lists_the_numeric_functions() -> None:
    assert {"transmittance", "Frame", "project", "register"} <= set(dir(sfumato))
    text = pydoc.plain(pydoc.render_doc(sfumato))
    assert "transmittance(" in text and "class Frame" in text


harness.main()
