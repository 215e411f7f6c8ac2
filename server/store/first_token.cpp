#include "server/store/first_token.h"

#include <fcntl.h>
#include <fmt/core.h>
#include <sys/stat.h>
#include <unistd.h>

#include <cerrno>
#include <cstdio>
#include <filesystem>

#include "core/base/result.h"
#include "core/base/sync_path.h"
#include "server/store/errno_error.h"
#include "server/store/scan_id.h"

namespace hermite::server {

namespace {

constexpr int kTokenBytes = 32;
constexpr std::size_t kTokenDigits = 2 * kTokenBytes;

// If the disk fills up meanwhile, no partial token is left that would make the next start fail.
std::string create_token(const std::string& path) {
  const std::string unfinished = path + ".new", token = random_hex(kTokenBytes),
                    line = token + "\n";
  const OwnedDescriptor file(
      open(unfinished.c_str(), O_WRONLY | O_CREAT | O_TRUNC | O_CLOEXEC | O_NOFOLLOW, 0600));
  if (file.descriptor < 0) throw SetupError(errno_error("creating " + unfinished));
  if (write(file.descriptor, line.data(), line.size()) != static_cast<ssize_t>(line.size()) ||
      fsync(file.descriptor) != 0)
    throw SetupError(errno_error("writing " + unfinished));
  if (rename(unfinished.c_str(), path.c_str()) != 0)
    throw SetupError(errno_error("creating " + path));
  or_throw(sync_path(std::filesystem::path(path).parent_path()));
  return token;
}

}  // namespace

std::string read_or_create_first_token(const std::string& path) {
  const OwnedDescriptor file(open(path.c_str(), O_RDONLY | O_CLOEXEC | O_NOFOLLOW));
  if (file.descriptor < 0 && errno == ENOENT) return create_token(path);
  if (file.descriptor < 0) throw SetupError(errno_error("opening " + path));
  const std::string token = first_token_in(file);
  if (token.empty())
    throw SetupError({ErrorCode::kCorruptData,
                      path + " holds no token of 64 hex digits; remove it and a new one is made"});
  if (fchmod(file.descriptor, 0600) != 0)
    throw SetupError(errno_error(fmt::format("making {} private", path)));
  return token;
}

std::string first_token_in(const OwnedDescriptor& file) {
  const std::string token = read_line(file, kTokenDigits + 2);
  const bool is_token = token.size() == kTokenDigits &&
                        token.find_first_not_of("0123456789abcdef") == std::string::npos;
  return is_token ? token : "";
}

}  // namespace hermite::server
