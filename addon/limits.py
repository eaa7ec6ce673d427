# SPDX-License-Identifier: GPL-3.0-or-later
"""How much of a kind is shown."""

# Bodies of smoke in a frame (MAX_MEDIA of native/media/medium_view.hpp).
MOST_BODIES = 64
# What the viewport's shader takes of them, and of lights (viewport/smoke_uniforms.glsl): each body has three of the 16
# textures that a shader may have.
MOST_MEDIA, MOST_LIGHTS = 5, 16
# Points of a cloud that are shown as spheres, of 1280 triangles each.
MOST_SPHERES = 100_000
