/* SPDX-License-Identifier: GPL-3.0-or-later */
/* A Python that has what Blender's own executable has in its global scope: linked with the libraries of a bpy wheel. There
   every C name that two libraries share is Blender's, which `import bpy` from a plain Python does not show. */
#include <Python.h>

int main(int count, char** arguments)
{
    return Py_BytesMain(count, arguments);
}
