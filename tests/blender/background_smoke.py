# SPDX-License-Identifier: GPL-3.0-or-later
"""The add-on is there, the sample is, and the one renders the other."""

import importlib
import shutil
import sys
from pathlib import Path

import addon_utils
import bpy
import harness
import numpy as np


def test_addon_is_enabled() -> None:
    assert addon_utils.check("sfumato")[1]


def test_addon_registers_without_its_native_module() -> None:
    addon_utils.disable("sfumato")
    folder = Path(bpy.app.tempdir)
    complete = Path(sys.modules["sfumato"].__file__).parent
    shutil.copytree(complete, folder / "bare_sfumato", ignore=shutil.ignore_patterns("_native", "__pycache__"))
    sys.path.append(str(folder))
    try:
        bare = importlib.import_module("bare_sfumato")
        bare.register()
        bare.unregister()
        assert "The native module does not load" in bare.core.problem()
    finally:
        sys.path.remove(str(folder))
        addon_utils.enable("sfumato")


def test_sample_holds_smoke() -> None:
    smoke = harness.open_plume()
    if harness.MANTAFLOW_ABORTS:
        assert smoke.data.grids["density"].channels == 1
    else:
        evaluated = smoke.evaluated_get(bpy.context.evaluated_depsgraph_get())
        assert max(evaluated.modifiers["Fluid"].domain_settings.density_grid) > 0.5


def test_sample_renders() -> None:
    """Over the sunlit floor, the top of the plume is brighter and the foot of its shadow is dark."""
    harness.open_plume()
    image = harness.render(resolution=(64, 36))
    assert image.shape == (36, 64, 4)
    assert np.isfinite(image).all()
    floor, plume, shadow = image[28, 50, 1], image[28, 19, 1], image[6, 27, 1]
    assert plume > 1.2 * floor
    assert shadow < 0.3 * floor


harness.main()
