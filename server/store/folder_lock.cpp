#include "server/store/folder_lock.h"

#include <fcntl.h>
#include <fmt/core.h>
#include <sys/file.h>
#include <unistd.h>

#include <cerrno>

#include "server/store/errno_error.h"
#include "server/store/first_token.h"

namespace hermite::server {

namespace {

// Locks an open file or folder; closes it if it cannot be locked.
int locked(int descriptor, const std::string& path) {
  if (descriptor < 0) throw SetupError(errno_error("opening " + path));
  if (flock(descriptor, LOCK_EX | LOCK_NB) == 0) return descriptor;
  const bool taken = errno == EWOULDBLOCK;
  const SetupError failure(errno_error("locking " + path));
  close(descriptor);
  if (taken)
    throw SetupError(
        {ErrorCode::kBusy,
         fmt::format("another server holds {}; give each server its own --data folder", path)});
  throw failure;
}

int take_lock(const std::string& path) {
  const int descriptor =
      locked(open(path.c_str(), O_RDWR | O_CREAT | O_CLOEXEC | O_NOFOLLOW, 0600), path);
  if (ftruncate(descriptor, 0) == 0) return descriptor;  // removes the address of an earlier server
  const SetupError failure(errno_error("emptying " + path));
  close(descriptor);
  throw failure;
}

}  // namespace

FolderLock::FolderLock(const std::string& folder)
    : path_(folder + "/lock"),
      file_(take_lock(path_)),
      folder_(locked(open(folder.c_str(), O_RDONLY | O_DIRECTORY | O_CLOEXEC), folder)) {}

Status FolderLock::publish_address(const std::string& url) const {
  const std::string line = url + "\n";
  if (pwrite(file_.descriptor, line.data(), line.size(), 0) != static_cast<ssize_t>(line.size()))
    return errno_error("writing " + path_);
  return Done{};
}

Result<PublishedServer> published_server(const std::string& folder) {
  constexpr std::size_t kMaxUrlBytes = 256;
  const OwnedDescriptor lock(open((folder + "/lock").c_str(), O_RDONLY | O_CLOEXEC | O_NOFOLLOW));
  const OwnedDescriptor token(open((folder + "/token").c_str(), O_RDONLY | O_CLOEXEC | O_NOFOLLOW));
  if (lock.descriptor < 0 || token.descriptor < 0)
    return Error{ErrorCode::kNotFound, errno_error("reading lock and token in " + folder).message};
  PublishedServer server{read_line(lock, kMaxUrlBytes), first_token_in(token)};
  if (server.url.empty() || server.token.empty())
    return Error{ErrorCode::kNotFound,
                 fmt::format("the program that uses {} has not said where it listens", folder)};
  return server;
}

}  // namespace hermite::server
