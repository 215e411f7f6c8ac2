// The error of a system call. Thread-safe.
#pragma once

#include <cerrno>
#include <cstring>
#include <string>

#include "core/base/result.h"

namespace hermite::server {

// Returns kIo with the reason that the system has given for the last failed call, after `what` was
// tried.
inline Error errno_error(const std::string& what) {
  return {ErrorCode::kIo, what + ": " + std::strerror(errno)};
}

}  // namespace hermite::server
