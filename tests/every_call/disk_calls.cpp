#include "tests/every_call/disk_calls.h"

#include <dlfcn.h>
#include <fcntl.h>
#include <sys/stat.h>
#include <unistd.h>

#include <atomic>
#include <cerrno>
#include <cstdio>
#include <string_view>

namespace hermite::test {

namespace {

std::atomic<DiskWatcher*> watcher = nullptr;

// Whether this call is to fail.
bool fails(const DiskCall& call) {
  DiskWatcher* const told = watcher.load();
  const int errno_before = errno;
  const int error = told ? told->before(call) : 0;
  errno = error != 0 ? error : errno_before;
  return error != 0;
}

template <class Function>
Function next(const char* name) {
  return reinterpret_cast<Function>(dlsym(RTLD_NEXT, name));
}

// Syncs in the way of that name.
int sync_file(const char* name, int (*real)(int), int descriptor) {
  if (fails({.name = name, .descriptor = descriptor})) return -1;
  const int result = real(descriptor);
  if (DiskWatcher* const told = result == 0 ? watcher.load() : nullptr) told->synced(descriptor);
  return result;
}

}  // namespace

void DiskWatcher::watch() { watcher = this; }

void DiskWatcher::unwatch() { watcher = nullptr; }

}  // namespace hermite::test

// The type of libc's function, what it changes (the fields of a DiskCall), and what a failure
// returns.
#define HERMITE_REPLACE(result, called, parameters, arguments, ...)                       \
  extern "C" result called parameters {                                                   \
    static const auto real = hermite::test::next<result(*) parameters>(#called);          \
    return hermite::test::fails({.name = #called, __VA_ARGS__}) ? static_cast<result>(-1) \
                                                                : real arguments;         \
  }

#define HERMITE_REPLACE_SYNC(name)                                          \
  extern "C" int name(int file) {                                           \
    static const auto real = hermite::test::next<int (*)(int file)>(#name); \
    return hermite::test::sync_file(#name, real, file);                     \
  }

HERMITE_REPLACE(ssize_t, write, (int file, const void* bytes, size_t count), (file, bytes, count),
                .descriptor = file)
HERMITE_REPLACE(ssize_t, pwrite, (int file, const void* bytes, size_t count, off_t at),
                (file, bytes, count, at), .descriptor = file)
HERMITE_REPLACE(ssize_t, pwrite64, (int file, const void* bytes, size_t count, off64_t at),
                (file, bytes, count, at), .descriptor = file)
HERMITE_REPLACE_SYNC(fsync)
HERMITE_REPLACE_SYNC(fdatasync)
HERMITE_REPLACE(int, ftruncate, (int file, off_t size) noexcept, (file, size), .descriptor = file)
HERMITE_REPLACE(int, ftruncate64, (int file, off64_t size) noexcept, (file, size),
                .descriptor = file)
HERMITE_REPLACE(int, rename, (const char* from, const char* to) noexcept, (from, to), .path = to)
HERMITE_REPLACE(int, mkdir, (const char* path, mode_t mode) noexcept, (path, mode), .path = path)
HERMITE_REPLACE(ssize_t, sendfile, (int to, int from, off_t* at, size_t count) noexcept,
                (to, from, at, count), .descriptor = to)
HERMITE_REPLACE(ssize_t, copy_file_range,
                (int from, off64_t* from_at, int to, off64_t* to_at, size_t count,
                 unsigned int flags),
                (from, from_at, to, to_at, count, flags), .descriptor = to)
