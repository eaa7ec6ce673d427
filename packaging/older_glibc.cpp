// SPDX-License-Identifier: GPL-3.0-or-later
// glibc 2.28 instead of the one that this is compiled on. Newer glibcs have the functions below twice: as they always
// were, and under a newer version, which is all that a compiler there asks for. The linker puts __wrap_NAME in the
// place of NAME, in the libraries that are linked in, too.
#include <cmath>
#include <cstddef>

#include <dlfcn.h>
#include <pthread.h>
#include <sched.h>
#include <sys/stat.h>

// A line for each, which CMake reads too.
#define REPLACED(NAME, VERSION, RESULT, PARAMETERS, ARGUMENTS)                                                         \
    extern "C" RESULT older_##NAME PARAMETERS;                                                                         \
    __asm__(".symver older_" #NAME ", " #NAME "@GLIBC_" VERSION);                                                      \
    extern "C" RESULT __wrap_##NAME PARAMETERS {                                                                       \
        return older_##NAME ARGUMENTS;                                                                                 \
    }

// clang-format off
// 2.29 and 2.35: their errors no longer go through a function of the program's own.
REPLACED(exp, "2.2.5", double, (double x), (x))
REPLACED(log, "2.2.5", double, (double x), (x))
REPLACED(pow, "2.2.5", double, (double x, double y), (x, y))
REPLACED(hypot, "2.2.5", double, (double x, double y), (x, y))

// 2.32 and 2.34: moved into libc.so from libpthread.so and libdl.so.
REPLACED(dlclose, "2.2.5", int, (void *library), (library))
REPLACED(dlerror, "2.2.5", char *, (), ())
REPLACED(dlopen, "2.2.5", void *, (const char *file, int mode), (file, mode))
REPLACED(dlsym, "2.2.5", void *, (void *library, const char *name), (library, name))
REPLACED(pthread_attr_getstack, "2.2.5", int, (const pthread_attr_t *a, void **at, std::size_t *size), (a, at, size))
REPLACED(pthread_attr_setstacksize, "2.2.5", int, (pthread_attr_t *a, std::size_t size), (a, size))
REPLACED(pthread_condattr_setclock, "2.3.3", int, (pthread_condattr_t *a, clockid_t clock), (a, clock))
REPLACED(pthread_create, "2.2.5", int, (pthread_t *t, const pthread_attr_t *a, void *(*f)(void *), void *x), (t, a, f, x))
REPLACED(pthread_detach, "2.2.5", int, (pthread_t t), (t))
REPLACED(pthread_getaffinity_np, "2.3.4", int, (pthread_t t, std::size_t size, cpu_set_t *cpus), (t, size, cpus))
REPLACED(pthread_getattr_np, "2.2.5", int, (pthread_t t, pthread_attr_t *a), (t, a))
REPLACED(pthread_getspecific, "2.2.5", void *, (pthread_key_t key), (key))
REPLACED(pthread_join, "2.2.5", int, (pthread_t t, void **result), (t, result))
REPLACED(pthread_key_create, "2.2.5", int, (pthread_key_t *key, void (*end)(void *)), (key, end))
REPLACED(pthread_key_delete, "2.2.5", int, (pthread_key_t key), (key))
REPLACED(pthread_mutex_trylock, "2.2.5", int, (pthread_mutex_t *mutex), (mutex))
REPLACED(pthread_mutexattr_destroy, "2.2.5", int, (pthread_mutexattr_t *a), (a))
REPLACED(pthread_mutexattr_init, "2.2.5", int, (pthread_mutexattr_t *a), (a))
REPLACED(pthread_mutexattr_settype, "2.2.5", int, (pthread_mutexattr_t *a, int type), (a, type))
REPLACED(pthread_once, "2.2.5", int, (pthread_once_t *done, void (*f)()), (done, f))
REPLACED(pthread_setaffinity_np, "2.3.4", int, (pthread_t t, std::size_t size, const cpu_set_t *cpus), (t, size, cpus))
REPLACED(pthread_setspecific, "2.2.5", int, (pthread_key_t key, const void *value), (key, value))
// clang-format on

// 2.33: functions of their own; before, one for all versions of the structure, of which this is the first and only.
extern "C" int older_fxstat(int version, int file, struct stat *status);
extern "C" int older_fxstat64(int version, int file, struct stat64 *status);
extern "C" int older_lxstat(int version, const char *path, struct stat *status);
extern "C" int older_xstat(int version, const char *path, struct stat *status);
__asm__(".symver older_fxstat, __fxstat@GLIBC_2.2.5");
__asm__(".symver older_fxstat64, __fxstat64@GLIBC_2.2.5");
__asm__(".symver older_lxstat, __lxstat@GLIBC_2.2.5");
__asm__(".symver older_xstat, __xstat@GLIBC_2.2.5");
extern "C" int __wrap_fstat(int file, struct stat *status) {
    return older_fxstat(1, file, status);
}
extern "C" int __wrap_fstat64(int file, struct stat64 *status) {
    return older_fxstat64(1, file, status);
}
extern "C" int __wrap_lstat(const char *path, struct stat *status) {
    return older_lxstat(1, path, status);
}
extern "C" int __wrap_stat(const char *path, struct stat *status) {
    return older_xstat(1, path, status);
}

// 2.32: whether libstdc++ may count without locks. Never.
extern "C" char __libc_single_threaded;
char __libc_single_threaded = 0;
