// SPDX-License-Identifier: GPL-3.0-or-later
// Transfer functions, their tables, and rays through smoke under them.
#include "media/classification.hpp"
#include "module/lights.hpp"
#include "module/parts.hpp"
#include "reference/preintegration.hpp"
#include "scene/scene.hpp"

namespace sfumato {
namespace {

using namespace arguments;
using arguments::Shape; // and not the scene's
using arguments::text;

constexpr double GREATEST = 1e12;  // of all that is multiplied
constexpr double FURTHEST = 1e5;   // cells
constexpr double SHORTEST = 1e-3;  // step, cells
constexpr std::size_t MOST = 4096; // entries

constexpr std::array<const char *, 4> METHODS{"post-classified", "mean-source", "full", "split"};

Doubles bounded(const py::object &given, double low, double high, const std::string &name) {
    Doubles out(any_array(given, name));
    require_range(out, low, high, name);
    return out;
}

TransferFunction transfer_of(const py::object &stops, const py::object &extinction, const py::object &colour,
                             const std::string &interpolation, bool associated) {
    const Doubles places = bounded(stops, -GREATEST, GREATEST, "stops");
    const Doubles extinctions = bounded(extinction, 0.0, GREATEST, "extinction");
    const Doubles colours = bounded(colour, 0.0, GREATEST, "colour");
    require_shape(places, {-1}, "stops");
    if (places.size() < 1) {
        throw py::value_error("stops has shape (0,), but must have at least one");
    }
    require_shape(extinctions, {places.size()}, "extinction");
    require_shape(colours, {places.size(), 3}, "colour");
    Ramp ramp;
    for (py::ssize_t i = 0; i < places.size(); ++i) {
        const double stop = places.data()[i];
        if (i > 0 && !(stop > ramp.stops.back())) {
            throw py::value_error("stops holds " + text(stop) + " at flat index " + text(i) + " and " +
                                  text(ramp.stops.back()) + " before it; each must be above the one before");
        }
        const double *const rgb = colours.data() + 3 * i;
        ramp.stops.push_back(stop);
        ramp.extinction.push_back(extinctions.data()[i]);
        ramp.colour.emplace_back(rgb[0], rgb[1], rgb[2]);
    }
    ramp.linear = one_of<2>(interpolation, {"linear", "constant"}, "interpolation") == 0;
    ramp.associated = associated;
    return TransferFunction(std::move(ramp));
}

SelfAttenuation self_attenuation_of(const std::string &given) {
    return static_cast<SelfAttenuation>(one_of<3>(given, {"full", "mean-source", "none"}, "self_attenuation"));
}

reference::Ramp judged(const TransferFunction &transfer) {
    const Ramp &ramp = transfer.ramp();
    return {ramp.stops, ramp.extinction, ramp.colour, ramp.linear, ramp.associated};
}

Shape shape_of_all(const Doubles &array) {
    return {array.shape(), array.shape() + array.ndim()};
}

// Four numbers for each item of a batch.
template <typename Four>
py::array_t<double> four_each(Shape shape, const Four &four) {
    const std::size_t count = product(shape);
    std::vector<double> out(4 * count);
    {
        const py::gil_scoped_release unlocked;
        for (std::size_t i = 0; i < count; ++i) {
            const glm::dvec4 value = four(i);
            for (std::size_t c = 0; c < 4; ++c) {
                out[4 * i + c] = value[static_cast<int>(c)];
            }
        }
    }
    shape.push_back(4);
    return to_numpy(std::move(out), std::move(shape));
}

py::array_t<double> at(const TransferFunction &transfer, const py::object &s) {
    const Doubles values = bounded(s, -GREATEST, GREATEST, "s");
    return four_each(shape_of_all(values), [&](std::size_t i) { return transfer.at(values.data()[i]); });
}

py::array_t<double> integral(const TransferFunction &transfer, const py::object &s) {
    const Doubles values = bounded(s, -GREATEST, GREATEST, "s");
    return four_each(shape_of_all(values), [&](std::size_t i) { return transfer.integral(values.data()[i]); });
}

// Both ends of steps: alike in shape, or one number for all.
struct Ends {
    Ends(const py::object &given_front, const py::object &given_back)
        : front(bounded(given_front, -GREATEST, GREATEST, "front")),
          back(bounded(given_back, -GREATEST, GREATEST, "back")), shape(shape_of_all(front.ndim() > 0 ? front : back)) {
        if (front.ndim() > 0 && back.ndim() > 0 && shape_of_all(back) != shape) {
            throw py::value_error("back has shape " + shape_of(back) + ", but must have that of front, " +
                                  shape_of(front));
        }
    }
    [[nodiscard]] double front_of(std::size_t i) const { return front.data()[front.ndim() > 0 ? i : 0]; }
    [[nodiscard]] double back_of(std::size_t i) const { return back.data()[back.ndim() > 0 ? i : 0]; }

    Doubles front, back;
    Shape shape;
};

py::array_t<double> segment(const TransferFunction &transfer, const py::object &front, const py::object &back,
                            double length, const std::string &self_attenuation) {
    const Ends ends(front, back);
    require_range(length, 0.0, GREATEST, "length");
    const SelfAttenuation how = self_attenuation_of(self_attenuation);
    return four_each(ends.shape, [&](std::size_t i) {
        const double a = ends.front_of(i), b = ends.back_of(i);
        return how == SelfAttenuation::FULL ? sent_by(transfer, a, b, length)
                                            : from_means(length * transfer.mean(a, b), how);
    });
}

PreintegratedTable table_of(const TransferFunction &transfer, const py::object &steps, int entries, double low,
                            double high, const std::string &self_attenuation) {
    const Doubles lengths = bounded(steps, 0.0, GREATEST, "steps");
    require_shape(lengths, {-1}, "steps");
    if (lengths.size() < 1 || lengths.size() > 64) {
        throw py::value_error("steps has shape " + shape_of(lengths) + ", but must have 1 to 64 lengths");
    }
    require_range(entries, 2, static_cast<int>(MOST), "entries");
    require_range(low, -GREATEST, GREATEST, "low");
    require_range(high, -GREATEST, GREATEST, "high");
    if (!(high > low)) {
        throw py::value_error("high is " + text(high) + ", but must be above low, " + text(low));
    }
    const SelfAttenuation how = self_attenuation_of(self_attenuation);
    std::vector<double> all(lengths.data(), lengths.data() + lengths.size());
    const py::gil_scoped_release unlocked;
    return {transfer.ramp(), low, high, static_cast<std::size_t>(entries), std::move(all), how};
}

py::array_t<float> values_of(const PreintegratedTable &table) {
    const auto count = static_cast<py::ssize_t>(table.entries());
    return to_numpy(std::vector<float>(table.values()),
                    {static_cast<py::ssize_t>(table.steps().size()), count, count, 4});
}

std::size_t rebuild(PreintegratedTable &table, const TransferFunction &transfer) {
    return table.rebuild(transfer.ramp());
}

py::array_t<double> look_up(const PreintegratedTable &table, const py::object &front, const py::object &back,
                            int step) {
    const Ends ends(front, back);
    require_range(step, 0, static_cast<int>(table.steps().size()) - 1, "step");
    return four_each(ends.shape, [&](std::size_t i) {
        return table.look_up(ends.front_of(i), ends.back_of(i), static_cast<std::size_t>(step));
    });
}

// Smoke and rays through it, in cells.
struct RaysInCells {
    RaysInCells(const py::object &given, const py::object &start, const py::object &end)
        : density(any_array(given, "density")), from(bounded(start, -FURTHEST, FURTHEST, "start")),
          to(bounded(end, -FURTHEST, FURTHEST, "end")), shape(leading_axes(from, {3}, "start")) {
        require_shape(density, {-1, -1, -1}, "density");
        require_range(density, -1e12F, 1e12F, "density");
        if (leading_axes(to, {3}, "end") != shape) {
            throw py::value_error("end has shape " + shape_of(to) + ", but must have that of start, " + shape_of(from));
        }
        const auto size = [this](py::ssize_t axis) { return static_cast<int>(density.shape(axis)); };
        cells = {density.data(), {size(2), size(1), size(0)}};
    }
    [[nodiscard]] CellRay ray(std::size_t i) const {
        const double *const a = from.data() + 3 * i, *const b = to.data() + 3 * i;
        return {{a[0], a[1], a[2]}, {b[0], b[1], b[2]}};
    }

    Floats density;
    Doubles from, to;
    Shape shape;
    DenseCells cells;
};

py::tuple classify_rays(const py::object &density, const py::object &start, const py::object &end,
                        const TransferFunction &transfer, const std::string &method, double step, int entries) {
    const RaysInCells rays(density, start, end);
    const auto how = static_cast<Classification>(one_of<4>(method, METHODS, "method"));
    require_range(step, SHORTEST, FURTHEST, "step");
    require_range(entries, 2, static_cast<int>(MOST), "entries");
    std::vector<std::int64_t> samples;
    std::optional<PreintegratedTable> table;
    if (how == Classification::FULL) {
        table = table_for(rays.cells, transfer.ramp(), step, static_cast<std::size_t>(entries));
    }
    const py::array_t<double> sent = four_each(rays.shape, [&](std::size_t i) {
        const Classified found = classify(rays.cells, rays.ray(i), transfer, how, step, table ? &*table : nullptr);
        samples.push_back(static_cast<std::int64_t>(found.samples));
        return found.sent;
    });
    return py::make_tuple(sent, to_numpy(std::move(samples), rays.shape));
}

py::tuple choose(const py::object &density, const py::object &start, const py::object &end,
                 const TransferFunction &transfer, double step, double error, int entries) {
    const RaysInCells rays(density, start, end);
    require_range(step, SHORTEST, FURTHEST, "step");
    require_range(error, 0.0, GREATEST, "error");
    require_range(entries, 2, static_cast<int>(MOST), "entries");
    std::vector<CellRay> all;
    for (std::size_t i = 0; i < product(rays.shape); ++i) {
        all.push_back(rays.ray(i));
    }
    ChosenClassification chosen;
    {
        const py::gil_scoped_release unlocked;
        chosen = choose_classification(rays.cells, all, transfer, step, error, static_cast<std::size_t>(entries));
    }
    py::dict errors;
    for (std::size_t i = 0; i < STEPPED; ++i) {
        errors[METHODS[i]] = chosen.errors[i];
    }
    return py::make_tuple(METHODS[static_cast<std::size_t>(chosen.how)], errors);
}

py::array_t<double> judged_segment(const TransferFunction &transfer, const py::object &front, const py::object &back,
                                   double length, int intervals) {
    const Ends ends(front, back);
    require_range(length, 0.0, GREATEST, "length");
    require_range(intervals, 1, 1'000'000, "intervals");
    return four_each(ends.shape, [&](std::size_t i) {
        return reference::sent(judged(transfer), ends.front_of(i), ends.back_of(i), length, intervals);
    });
}

py::array_t<double> judged_along(const TransferFunction &transfer, const py::object &density, const py::object &start,
                                 const py::object &end, int points) {
    const RaysInCells rays(density, start, end);
    require_range(points, 1, 1'000'000, "points");
    Medium medium;
    medium.resolution = glm::uvec3(rays.cells.size);
    medium.density.assign(rays.density.data(), rays.density.data() + rays.density.size());
    medium.grid_to_world = glm::mat4(1.0F);
    return four_each(rays.shape, [&](std::size_t i) {
        return reference::sent_along(judged(transfer), medium, rays.ray(i).from, rays.ray(i).to, points);
    });
}

py::array_t<double> judged_table(const TransferFunction &transfer, double step, int entries, double low, double high) {
    require_range(step, 0.0, GREATEST, "step");
    require_range(entries, 2, static_cast<int>(MOST), "entries");
    require_range(low, -GREATEST, GREATEST, "low");
    require_range(high, -GREATEST, GREATEST, "high");
    std::vector<glm::dvec4> table;
    {
        const py::gil_scoped_release unlocked;
        table = reference::table(judged(transfer), low, high, entries, step);
    }
    return four_each({entries, entries}, [&](std::size_t i) { return table[i]; });
}

void bind_table(py::module_ &m) {
    py::class_<PreintegratedTable>(m, "PreintegratedTable",
                                   R"(What a step of a ray sends to the eye, by the values at both its ends.

PreintegratedTable(transfer, steps) is a TransferFunction's, for the lengths `steps` (k,), at `entries` values from low to
high in front and behind. Of a step's own smoke before the rest of it, self_attenuation counts "full": all, to 1e-6 of
what is opaque; as a "mean-source": as if extinction and emission were mixed, right where there is one colour; or "none".

>>> red = TransferFunction([0, 1], [0, 2], [(1, 0, 0), (1, 0, 0)], associated=False)
>>> table = PreintegratedTable(red, steps=[1.0, 2.0], entries=5)
>>> table.values.shape
(2, 5, 5, 4)
>>> table.values[1, 0, 4].astype(float).round(3).tolist()  # opacity 1 - exp(-2)
[0.865, 0.0, 0.0, 0.865]
)")
        .def(py::init(&table_of), py::arg("transfer"), py::arg("steps"), py::arg("entries") = 256, py::arg("low") = 0.0,
             py::arg("high") = 1.0, py::arg("self_attenuation") = "full")
        .def_property_readonly("values", &values_of,
                               "(k, entries, entries, 4) float32, a copy: by step, value in front, value behind; "
                               "radiance, RGB, and opacity.")
        .def(
            "rebuild", &rebuild, py::arg("transfer"), py::call_guard<py::gil_scoped_release>(),
            R"(Makes it, to the last bit, the table of another TransferFunction. Returns how many entries it went through:
those whose values lie around what changed.

>>> ramp = lambda middle: TransferFunction([0, middle, 1], [0, 1, 0], [(1, 1, 1)] * 3)
>>> table = PreintegratedTable(ramp(0.5), steps=[1.0], entries=64)
>>> table.rebuild(ramp(0.5)), table.rebuild(ramp(0.6))
(0, 4096)
)")
        .def(
            "look_up", &look_up, py::arg("front"), py::arg("back"), py::arg("step") = 0,
            R"((..., 4): radiance, RGB, and transmittance, bilinear between entries; `step` is the number of one of steps.

>>> import numpy as np
>>> white = TransferFunction([0, 1], [0, 2], [(1, 1, 1), (1, 1, 1)], associated=False)
>>> PreintegratedTable(white, steps=[1.0]).look_up(np.array([0.0]), np.array([1.0])).round(3).tolist()
[[0.632, 0.632, 0.632, 0.368]]
)");
}

void bind_rays(py::module_ &m) {
    m.def(
        "classify", &classify_rays, py::arg("density"), py::arg("start"), py::arg("end"), py::arg("transfer"),
        py::arg("method") = "split", py::arg("step") = 1.0, py::arg("entries") = 256,
        R"(What smoke sends along rays under a TransferFunction: (..., 4), radiance, RGB, and transmittance; and (...), how
many samples of the smoke that took.

density (nz, ny, nx), trilinear between the centres of cells, zero off the grid; start and end (..., 3) in cells, x first,
of which the first has its centre at (.5, .5, .5). Extinction and emission are per cell. Methods: "post-classified", in
the middle of each step; "mean-source", exact means between both ends; "full", a table of entries^2; "split": along a ray
trilinear smoke is one cubic in each cell, which is cut where it meets the stops, without steps.

>>> import numpy as np
>>> fog = TransferFunction([0, 1], [0, 0.5], [(1, 1, 1), (1, 1, 1)], associated=False)
>>> sent, samples = classify(np.ones((4, 4, 4)), (-1, 2, 2), (5, 2, 2), fog)
>>> sent.round(3).tolist(), int(samples)  # an optical depth of 2
([0.865, 0.865, 0.865, 0.135], 22)
)");
    m.def(
        "choose_classification", &choose, py::arg("density"), py::arg("start"), py::arg("end"), py::arg("transfer"),
        py::arg("step") = 1.0, py::arg("error") = 1e-3, py::arg("entries") = 256,
        R"(The method of classify that a ramp needs, and the errors of those that step: root mean square over the rays by
the mean radiance, against "split". The cheapest of them whose error is at most `error` and within a fiftieth of the
best; where there is none, "split". The other arguments as in classify.

>>> import numpy as np
>>> z = np.linspace(-1, 1, 16)
>>> ball = np.maximum(0, 1 - z**2 - z[:, None]**2 - z[:, None, None]**2)
>>> start = np.random.default_rng(1).uniform(4, 12, (20, 3)) * (1, 1, 0)
>>> peak = TransferFunction([0.49, 0.5, 0.51], [0, 1, 0], [(1, 1, 1)] * 3)
>>> choose_classification(ball, start, start + (3, 2, 16), peak)[0]
'split'
)");
}

} // namespace

void bind_transfer(py::module_ &m) {
    py::class_<TransferFunction>(m, "TransferFunction",
                                 R"(Extinction and emission of smoke as functions of one number: a ramp.

Given at stops (n,), each above the one before: extinction (n,) per unit of length, and colour (n, 3), RGB. Between stops
"linear", or "constant": the value of a stop holds up to the next. Below the first stop and above the last everything is
as it is there. Colours are what a unit of length emits; where they are not `associated`, the radiance of the smoke where
it is opaque, of which the product with the extinction is emitted.

>>> TransferFunction([0, 1], [0, 2], [(0, 0, 0), (1, 2, 3)]).at([0.5]).tolist()
[[0.5, 1.0, 1.5, 1.0]]
>>> TransferFunction([0.2, 0.2], [0, 2], [(0, 0, 0), (1, 2, 3)])
Traceback (most recent call last):
ValueError: stops holds 0.2 at flat index 1 and 0.2 before it; each must be above the one before
)")
        .def(py::init(&transfer_of), py::arg("stops"), py::arg("extinction"), py::arg("colour"),
             py::arg("interpolation") = "linear", py::arg("associated") = true)
        .def("at", &at, py::arg("s"),
             R"((..., 4) float64: emission, RGB, and extinction, both per unit of length, at values (...).

>>> TransferFunction([0, 1], [3, 0], [(1, 1, 1), (0, 0, 0)], interpolation="constant").at([-1, 0.9, 1.0]).tolist()
[[1.0, 1.0, 1.0, 3.0], [1.0, 1.0, 1.0, 3.0], [0.0, 0.0, 0.0, 0.0]]
)")
        .def("integral", &integral, py::arg("s"),
             R"((..., 4) float64: the integral of at() from the first stop to values (...), exact but for rounding.

>>> TransferFunction([0, 1], [0, 3], [(0, 0, 0), (1, 1, 1)], associated=False).integral(2.0).tolist()
[4.0, 4.0, 4.0, 4.5]
)")
        .def(
            "segment", &segment, py::arg("front"), py::arg("back"), py::arg("length") = 1.0,
            py::arg("self_attenuation") = "full",
            R"((..., 4) float64: what a length of smoke sends to the eye, radiance, RGB, and transmittance, where the value
goes straight from front (...) to back (...). As entries of a PreintegratedTable, without a table.

>>> glow = TransferFunction([0, 1], [0, 4], [(0, 0, 0), (4, 0, 0)])
>>> glow.segment([0, 0], [1, 0]).round(4).tolist()
[[0.8647, 0.0, 0.0, 0.1353], [0.0, 0.0, 0.0, 1.0]]
>>> float(glow.segment(0.0, 1.0, self_attenuation="none")[0])
2.0
)");
    bind_table(m);
    bind_rays(m);
}

void bind_reference_transfer(py::module_ &m) {
    m.def("sent", &judged_segment, py::arg("transfer"), py::arg("front"), py::arg("back"), py::arg("length") = 1.0,
          py::arg("intervals") = 400,
          R"((..., 4): TransferFunction.segment() by Simpson's rule, in so many intervals between any two stops.

>>> glow = TransferFunction([0, 1], [0, 4], [(0, 0, 0), (4, 0, 0)])
>>> reference.sent(glow, [0.0], [1.0]).round(6).tolist()
[[0.864665, 0.0, 0.0, 0.135335]]
)");
    m.def("sent_along", &judged_along, py::arg("transfer"), py::arg("density"), py::arg("start"), py::arg("end"),
          py::arg("points") = 256,
          R"((..., 4): what classify() approximates, by straight lines between so many points of each cell.

>>> import numpy as np
>>> fog = TransferFunction([0, 1], [0, 0.5], [(1, 1, 1), (1, 1, 1)], associated=False)
>>> reference.sent_along(fog, np.ones((4, 4, 4)), (-1, 2, 2), (5, 2, 2)).round(6).tolist()
[0.864665, 0.864665, 0.864665, 0.135335]
)");
    m.def(
        "table", &judged_table, py::arg("transfer"), py::arg("step"), py::arg("entries") = 64, py::arg("low") = 0.0,
        py::arg("high") = 1.0,
        R"((entries, entries, 4): radiance and transmittance, each entry by itself, slab by slab, in each of which extinction
and emission are what they are in its middle.

>>> white = TransferFunction([0, 1], [0, 2], [(1, 1, 1), (1, 1, 1)], associated=False)
>>> reference.table(white, step=1.0, entries=9)[0, 8].round(3).tolist()
[0.632, 0.632, 0.632, 0.368]
)");
}

} // namespace sfumato
