// SPDX-License-Identifier: GPL-3.0-or-later
// What the sanitizers leave alone; compiled into the test programs of the presets asan and tsan.
// tsan has no list: Debian's oneTBB is compiled without it, so that all that passes through a task looks like a race,
// and a list that leaves out tasks would leave out all of our threads. It takes a oneTBB that was built with it too.

// Embree and oneTBB keep their pools until the process ends, and so does GoogleTest its list of tests. volume_file_test
// uses none of them; its leaks are looked for, and what it frees is not kept for watching, since it counts its pages.
extern "C" const char *__asan_default_options() {
#ifdef COUNTS_PAGES
    return "quarantine_size_mb=0:thread_local_quarantine_size_kb=0:allocator_release_to_os_interval_ms=0";
#else
    return "detect_leaks=0";
#endif
}

extern "C" const char *__ubsan_default_options() {
    return "print_stacktrace=1";
}
