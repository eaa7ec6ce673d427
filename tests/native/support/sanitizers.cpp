// SPDX-License-Identifier: GPL-3.0-or-later
// What the sanitizers leave alone; compiled into the test programs of the presets asan and tsan.

// Embree and oneTBB keep their pools until the process ends, and so does GoogleTest its list of tests.
extern "C" const char *__asan_default_options() {
    return "detect_leaks=0";
}

extern "C" const char *__ubsan_default_options() {
    return "print_stacktrace=1";
}
