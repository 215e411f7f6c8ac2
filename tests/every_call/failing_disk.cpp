#include "tests/every_call/failing_disk.h"

#include <dlfcn.h>
#include <fcntl.h>
#include <sys/stat.h>
#include <unistd.h>

#include <atomic>
#include <cerrno>
#include <cstdarg>
#include <cstdio>

namespace hermite::test {

namespace {

std::atomic<bool> armed = false;
std::atomic<int> calls_left = 0;  // before the one that fails
std::atomic<int> error_number = 0;
std::atomic<bool> stays = false;
std::atomic<const char*> failed = nullptr;

// Whether this call is to fail.
bool fails(const char* name) {
  if (!armed.load()) return false;
  const int left = calls_left.fetch_sub(1);
  if (left > 0 || (left < 0 && !stays.load())) return false;
  const char* none = nullptr;
  failed.compare_exchange_strong(none, name);
  errno = error_number.load();
  return true;
}

template <class Function>
Function next(const char* name) {
  return reinterpret_cast<Function>(dlsym(RTLD_NEXT, name));
}

}  // namespace

FailingDisk::FailingDisk(int number, int error, bool and_all_after) {
  calls_left = number;
  error_number = error;
  stays = and_all_after;
  failed = nullptr;
  armed = true;
}

FailingDisk::~FailingDisk() { armed = false; }

bool FailingDisk::has_failed() const { return failed.load() != nullptr; }

std::string FailingDisk::failed_call() const { return has_failed() ? failed.load() : ""; }

}  // namespace hermite::test

// A constant for each: the type of libc's function, and what a failure returns.
#define HERMITE_REPLACE(result, name, parameters, arguments)                       \
  extern "C" result name parameters {                                              \
    static const auto real = hermite::test::next<result(*) parameters>(#name);     \
    return hermite::test::fails(#name) ? static_cast<result>(-1) : real arguments; \
  }

HERMITE_REPLACE(ssize_t, write, (int file, const void* bytes, size_t count), (file, bytes, count))
HERMITE_REPLACE(ssize_t, pwrite, (int file, const void* bytes, size_t count, off_t at), (file, bytes, count, at))
HERMITE_REPLACE(ssize_t, pwrite64, (int file, const void* bytes, size_t count, off64_t at), (file, bytes, count, at))
HERMITE_REPLACE(int, fsync, (int file), (file))
HERMITE_REPLACE(int, fdatasync, (int file), (file))
HERMITE_REPLACE(int, ftruncate, (int file, off_t size) noexcept, (file, size))
HERMITE_REPLACE(int, ftruncate64, (int file, off64_t size) noexcept, (file, size))
HERMITE_REPLACE(int, rename, (const char* from, const char* to) noexcept, (from, to))
HERMITE_REPLACE(int, mkdir, (const char* path, mode_t mode) noexcept, (path, mode))
HERMITE_REPLACE(ssize_t, sendfile, (int to, int from, off_t* at, size_t count) noexcept, (to, from, at, count))
HERMITE_REPLACE(ssize_t, copy_file_range, (int from, off64_t* from_at, int to, off64_t* to_at, size_t count, unsigned int flags),
                (from, from_at, to, to_at, count, flags))
