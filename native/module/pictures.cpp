// SPDX-License-Identifier: GPL-3.0-or-later
// Pictures in files.
#include "module/parts.hpp"
#include "scene/picture_file.hpp"

#include <pybind11/stl.h>

namespace sfumato {

void bind_pictures(pybind11::module_ &m) {
    namespace py = pybind11;
    m.def(
        "unreadable_picture", &unreadable, py::arg("path"), py::call_guard<py::gil_scoped_release>(),
        R"(Why a picture cannot be read whole, naming its file; None where all its pixels can. Of a format that is not known
here only whether there is a file that holds something.

>>> unreadable_picture("missing.png")
"'missing.png' cannot be read whole: there is no such file"
)");
}

} // namespace sfumato
