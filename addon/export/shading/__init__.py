# SPDX-License-Identifier: GPL-3.0-or-later
"""Volume shaders as functions of grids: read from Blender's nodes into expressions, and evaluated on arrays of cells."""
