#include "core/base/sync_path.h"

#include <fcntl.h>
#include <unistd.h>

#include <cerrno>
#include <cstring>

namespace hermite {

Status sync_path(const std::string& path) {
  const auto failure = [&path](const char* what) {
    return Error{ErrorCode::kIo, what + path + ": " + std::strerror(errno)};
  };
  const int descriptor = open(path.c_str(), O_RDONLY | O_CLOEXEC);
  if (descriptor < 0) return failure("opening ");
  const Status synced = fsync(descriptor) == 0 ? Status(Done{}) : Status(failure("syncing "));
  close(descriptor);
  return synced;
}

}  // namespace hermite
