// SPDX-License-Identifier: GPL-3.0-or-later
// What is said of a call that fits no signature: one line that names the argument and its value. pybind11 answers with
// all of the signature and all values, arrays and all. So each function of the module is put behind one that takes any
// arguments, hands them on, and only where that answer comes back looks for what is wrong with them.
#include "module/arguments.hpp"
#include "module/parts.hpp"

#include <algorithm>
#include <limits>

namespace sfumato {
namespace {

using namespace arguments;

struct Parameter {
    std::string name;
    std::string type; // as pybind11 writes it
    bool has_default = false;
};

// A kind of value: what a type's text holds of it, what it is called, and whether a value is one.
struct Kind {
    const char *marker;
    const char *words;
    bool (*holds)(py::handle value);
};

bool is_whole(py::handle value) {
    const auto number = py::reinterpret_steal<py::object>(PyNumber_Index(value.ptr()));
    const long long whole = number ? PyLong_AsLongLong(number.ptr()) : -1;
    const bool failed = PyErr_Occurred() != nullptr;
    PyErr_Clear();
    return !failed && whole >= std::numeric_limits<int>::min() && whole <= std::numeric_limits<int>::max();
}

bool is_number(py::handle value) {
    const auto number = py::reinterpret_steal<py::object>(PyNumber_Float(value.ptr()));
    PyErr_Clear();
    return number && !PyUnicode_Check(value.ptr());
}

bool is_array(py::handle value) {
    const py::array array = py::array::ensure(value);
    return array && std::string_view("fiub").find(array.dtype().kind()) != std::string_view::npos;
}

bool is_text(py::handle value) {
    return PyUnicode_Check(value.ptr()) != 0;
}

bool is_function(py::handle value) {
    return PyCallable_Check(value.ptr()) != 0;
}

bool is_switch(py::handle value) {
    return PyBool_Check(value.ptr()) != 0 || is_whole(value);
}

bool is_bytes(py::handle value) {
    return py::isinstance<py::array_t<std::uint8_t>>(value);
}

bool is_triple(py::handle value) {
    return PySequence_Check(value.ptr()) != 0 && py::len(value) == 3 &&
           std::all_of(value.begin(), value.end(), &is_whole);
}

bool is_list(py::handle value) {
    return py::isinstance<py::list>(value);
}

bool are_texts(py::handle value) {
    return PySequence_Check(value.ptr()) != 0 && !is_text(value) && std::all_of(value.begin(), value.end(), &is_text);
}

// In the order in which they are looked for: the type of an array names that of its numbers, too, that of a function
// what it is given.
constexpr std::array KINDS{
    Kind{"Callable", "a function", &is_function},
    Kind{"uint8", "an array of uint8", &is_bytes},
    Kind{"List[str]", "a list of texts", &are_texts},
    Kind{"Sequence[str]", "a list of texts", &are_texts},
    Kind{"list", "a list", &is_list},
    Kind{"numpy", "an array of real numbers", &is_array},
    Kind{"object", "an array of real numbers", &is_array},
    Kind{"int[3]", "three whole numbers", &is_triple},
    Kind{"FixedSize(3)", "three whole numbers", &is_triple},
    Kind{"bool", "True or False", &is_switch},
    Kind{"int", "a whole number of at most 31 bits", &is_whole},
    Kind{"Int", "a whole number of at most 31 bits", &is_whole},
    Kind{"loat", "a number", &is_number},
    Kind{"str", "a text", &is_text},
};

constexpr std::string_view OWN = "sfumato.";
constexpr std::string_view LETTERS = "ABCDEFGHIJKLMNOPQRSTUVWXYZabcdefghijklmnopqrstuvwxyz";

// The parts between commas that no bracket and no quotation mark encloses.
std::vector<std::string> parts_of(std::string_view text) {
    std::vector<std::string> parts(1);
    int depth = 0;
    bool quoted = false;
    for (const char letter : text) {
        quoted = quoted != (letter == '\'');
        depth += quoted ? 0 : static_cast<int>(letter == '(' || letter == '[');
        depth -= quoted ? 0 : static_cast<int>(letter == ')' || letter == ']');
        if (depth < 0) {
            break; // the bracket that closes the list
        }
        if (letter == ',' && depth == 0 && !quoted) {
            parts.emplace_back();
        } else if (letter != ' ' || !parts.back().empty()) {
            parts.back() += letter;
        }
    }
    return parts;
}

// Of a signature as pybind11 writes it, "name(first: type, second: type = default) -> type"; self is left out.
std::vector<Parameter> parameters_of(std::string_view signature) {
    std::vector<Parameter> parameters;
    for (const std::string &part : parts_of(signature.substr(signature.find('(') + 1))) {
        const auto colon = part.find(": ");
        const auto equals = part.find(" = ");
        if (colon == std::string::npos || part.starts_with("self:")) {
            continue;
        }
        const std::string type = part.substr(colon + 2, equals - colon - 2);
        parameters.push_back({part.substr(0, colon), type, equals != std::string::npos});
        if (part.ends_with("= None")) {
            parameters.back().type += " | None";
        }
    }
    return parameters;
}

// Nothing where the value is of the parameter's type, else what it must be.
std::string wanted(const Parameter &parameter, py::handle value) {
    const std::string_view type = parameter.type;
    const auto says = [type](std::string_view word) { return type.find(word) != std::string_view::npos; };
    if (value.is_none() && (says("None") || says("Optional"))) {
        return {};
    }
    std::string words;
    for (auto start = type.find(OWN); start != std::string_view::npos; start = type.find(OWN, start + 1)) {
        const std::string_view rest = type.substr(start + OWN.size());
        const std::string kind(rest.substr(0, rest.find_first_not_of(LETTERS)));
        if (py::str(py::type::handle_of(value).attr("__name__")).equal(py::str(kind))) {
            return {};
        }
        words += (words.empty() ? "a " : " or a ") + kind;
    }
    for (const Kind &kind : KINDS) {
        if (!says(kind.marker)) {
            continue;
        }
        if (kind.holds(value)) {
            return {};
        }
        return (words.empty() ? "" : words + " or ") + kind.words;
    }
    return words;
}

// Of a call that does not fit: the first argument that is missing, too many, or not of its type.
[[noreturn]] void refuse(const std::string &name, const std::vector<Parameter> &parameters, const py::tuple &given,
                         const py::dict &named) {
    std::string takes;
    for (const Parameter &parameter : parameters) {
        takes += (takes.empty() ? "takes " : ", ") + parameter.name;
    }
    takes = takes.empty() ? "takes no arguments" : takes;
    if (given.size() > parameters.size()) {
        throw py::type_error(name + " was given " + text(given.size()) + " arguments, but " + takes);
    }
    for (const auto &[key, value] : named) {
        const auto same = [word = std::string(py::str(key))](const Parameter &each) { return each.name == word; };
        const auto found = std::ranges::find_if(parameters, same);
        if (found == parameters.end()) {
            throw py::type_error(name + " has no argument " + told(key) + "; it " + takes);
        }
        if (static_cast<std::size_t>(found - parameters.begin()) < given.size()) {
            throw py::type_error(found->name + " is given twice to " + name);
        }
    }
    for (std::size_t i = 0; i < parameters.size(); ++i) {
        const Parameter &parameter = parameters[i];
        const bool by_name = named.contains(parameter.name.c_str());
        if (i >= given.size() && !by_name) {
            if (!parameter.has_default) {
                throw py::type_error(parameter.name + " is missing: " + name + " " + takes);
            }
            continue;
        }
        const py::object value = by_name ? py::object(named[parameter.name.c_str()]) : py::object(given[i]);
        if (const std::string must = wanted(parameter, value); !must.empty()) {
            throw py::value_error(parameter.name + " is " + told(value) + ", but must be " + must);
        }
    }
    throw py::type_error(name + " cannot use these arguments: it " + takes);
}

// `function`, which says `doc` of itself, behind one that refuses plainly; `self` is how many arguments its owner is.
auto behind(const py::object &function, const std::string &name, const std::string &doc, py::size_t self) {
    const std::string refusal = "TypeError: " + std::string(py::str(function.attr("__name__"))) + "(): incompatible";
    return [=](const py::args &given, const py::kwargs &named) -> py::object {
        try {
            return function(*given, **named);
        } catch (const py::error_already_set &error) {
            if (!std::string_view(error.what()).starts_with(refusal)) {
                throw;
            }
        }
        refuse(name, parameters_of(doc), given[py::slice(static_cast<py::ssize_t>(self), PY_SSIZE_T_MAX, 1)], named);
    };
}

// Every public function of a module or of a class.
void put_behind(const py::object &owner) {
    const bool is_class = PyType_Check(owner.ptr()) != 0;
    for (const auto &[key, value] : py::dict(owner.attr("__dict__").attr("copy")())) {
        const auto name = std::string(py::str(key));
        const bool makes = name == "__init__";
        if (name.starts_with('_') && !makes) {
            continue;
        }
        if (PyType_Check(value.ptr()) != 0 || PyModule_Check(value.ptr()) != 0) {
            put_behind(py::reinterpret_borrow<py::object>(value));
            continue;
        }
        const bool is_static = PyObject_TypeCheck(value.ptr(), &PyStaticMethod_Type) != 0;
        const bool is_method = PyInstanceMethod_Check(value.ptr()) != 0;
        if (!is_static && !is_method && PyCFunction_Check(value.ptr()) == 0) {
            continue;
        }
        const py::object function = owner.attr(name.c_str());
        const auto doc = std::string(py::str(function.attr("__doc__")));
        const std::string called = makes ? std::string(py::str(owner.attr("__name__"))) : name;
        const auto call = behind(function, called, doc, is_method ? 1 : 0);
        if (is_method) {
            // Not called __init__: pybind11 would take it for one of its own, which are given memory to fill.
            owner.attr(name.c_str()) =
                py::cpp_function(call, py::name(called.c_str()), py::is_method(owner), doc.c_str());
        } else if (is_static && is_class) {
            owner.attr(name.c_str()) = py::staticmethod(py::cpp_function(call, py::name(called.c_str()), doc.c_str()));
        } else {
            owner.attr(name.c_str()) = py::cpp_function(call, py::name(called.c_str()), py::scope(owner), doc.c_str());
        }
    }
}

} // namespace

void refuse_plainly(py::module_ &m) {
    py::options options;
    options.disable_function_signatures(); // each text has its own
    put_behind(m);
}

} // namespace sfumato
