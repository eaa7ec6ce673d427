# SPDX-License-Identifier: GPL-3.0-or-later
"""The add-on is there, and so is the sample."""

import addon_utils
import bpy
import harness


def test_addon_is_enabled() -> None:
    assert addon_utils.check("sfumato")[1]


def test_sample_holds_smoke() -> None:
    smoke = harness.open_plume()
    if harness.MANTAFLOW_ABORTS:
        assert smoke.data.grids["density"].channels == 1
    else:
        evaluated = smoke.evaluated_get(bpy.context.evaluated_depsgraph_get())
        assert max(evaluated.modifiers["Fluid"].domain_settings.density_grid) > 0.5


harness.main()
