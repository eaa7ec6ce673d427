# SPDX-License-Identifier: GPL-3.0-or-later
"""The sidebar's texts fit it, and are of what its view shows."""

from __future__ import annotations

import blf
import bpy
import harness
import screen
from sfumato import log, ui  # type: ignore[attr-defined]

TEXT = (
    "12 objects: Transmission of 0.2 to 0.9 is not shown; /a/path/that/is/longer/than/any/line/of/a/panel.vdb is opaque"
)


def test_a_text_keeps_to_its_width_and_loses_nothing() -> None:
    for width in (40, 117, 230):
        lines = list(ui.lines_of(TEXT, width))
        assert max(blf.dimensions(ui.FONT, line)[0] for line in lines) <= width
        assert "".join(lines).replace(" ", "") == TEXT.replace(" ", "")
    # No line of whole words is shorter than it need be.
    lines = list(ui.lines_of(TEXT.partition("/")[0], 117))
    for line, following in zip(lines, lines[1:]):
        assert blf.dimensions(ui.FONT, f"{line} {following.split()[0]}")[0] > 117
    assert list(ui.lines_of("short", 230)) == ["short"]


def test_a_view_hears_of_what_it_shows() -> None:
    window, area, region = screen.viewport()
    for source in ("render", "view", "viewport"):
        log.replace(source, [f"of the {source}"])
    panel = ui.SfumatoViewportNoticesPanel
    expected = {("SOLID", "BLENDER_WORKBENCH"): "viewport", ("RENDERED", "SFUMATO"): "view",
                ("RENDERED", "BLENDER_WORKBENCH"): "", ("WIREFRAME", "SFUMATO"): ""}  # fmt: skip
    with bpy.context.temp_override(window=window, area=area, region=region):
        for (shading, engine), source in expected.items():
            bpy.context.scene.render.engine = engine
            area.spaces.active.shading.type = shading
            said = log.notices(*panel.sources(bpy.context))
            assert said == ([f"of the {source}"] if source else []), (shading, engine, said)
            assert panel.poll(bpy.context) == bool(source)
        area.spaces.active.shading.type = "SOLID"
        bpy.context.scene.sfumato.viewport_enabled = False
        assert not panel.poll(bpy.context)
    log.clear()


harness.main()
