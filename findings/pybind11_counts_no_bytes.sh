#!/usr/bin/env bash
# SPDX-License-Identifier: GPL-3.0-or-later
# Usage: findings/pybind11_counts_no_bytes.sh
#
# pybind11 2.11.1 (Debian 12's 2.10 alike) under NumPy 2: a module that was compiled with it imports, and takes and gives
# arrays without an error; but `py::array::itemsize()` and `nbytes()`, and `py::dtype::itemsize()`, read a field that NumPy 2
# moved, and are 0. A hash over `data(), nbytes()` is then the hash of nothing, equal for all arrays. Python's buffer
# protocol, `array.request()`, has the right numbers. Blender before 5.1 has NumPy 1, from then on 2. pybind11 2.12 knows both.
#
# Seen, for three doubles:
#   numpy 1.26.4: nbytes 24, by the buffer protocol 24
#   numpy 2.2.6: nbytes 0, by the buffer protocol 24
#
# Fails if that changes.

set -euo pipefail
folder=$(mktemp -d)
trap 'rm -rf "$folder"' EXIT
python3.11 -m venv "$folder/env"
python=$folder/env/bin/python
"$python" -m pip install --quiet 'pybind11==2.11.1'
cat >"$folder/bytes.cpp" <<'CPP'
#include <pybind11/numpy.h>
namespace py = pybind11;
PYBIND11_MODULE(counted, module) {
    module.def("counted", [](const py::array &array) {
        const py::buffer_info buffer = array.request();
        return py::make_tuple(array.nbytes(), buffer.size * buffer.itemsize);
    });
}
CPP
# shellcheck disable=SC2046 # two options
g++ -std=c++17 -O1 -shared -fPIC $("$python" -m pybind11 --includes) "$folder/bytes.cpp" -o "$folder/counted.so"
for version in 1.26.4 2.2.6; do
    "$python" -m pip install --quiet "numpy==$version"
    PYTHONPATH=$folder "$python" - <<'PYTHON'
import counted
import numpy as np

nbytes, by_protocol = counted.counted(np.zeros(3))
print(f"numpy {np.__version__}: nbytes {nbytes}, by the buffer protocol {by_protocol}")
assert by_protocol == 24 and nbytes == (24 if np.__version__.startswith("1.") else 0), (nbytes, by_protocol)
PYTHON
done
