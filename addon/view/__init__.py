# SPDX-License-Identifier: GPL-3.0-or-later
"""The 3D viewport: Rendered views, and the smoke over Blender's own."""
