#include "server/store/place_note.h"

#include <fmt/core.h>
#include <unistd.h>

#include <cerrno>
#include <cstdio>
#include <cstring>
#include <fstream>

#include "core/base/sync_path.h"
#include "core/output/ply.h"

namespace hermite::server {

Result<std::optional<PlaceNote>> read_place_note(const std::string& path) {
  if (access(path.c_str(), F_OK) != 0) {
    if (errno != ENOENT) return Error{ErrorCode::kIo, path + ": " + std::strerror(errno)};
    return std::optional<PlaceNote>();
  }
  std::ifstream file(path);
  PlaceNote note;
  if (!(file >> note.address >> note.id))
    return Error{ErrorCode::kCorruptData, path + " should have two lines, an address and an id"};
  return std::optional(note);
}

Status write_place_note(const std::string& path, const PlaceNote& note) {
  return output::write_file_atomically(path, fmt::format("{}\n{}\n", note.address, note.id));
}

Status rename_in_folder(const std::string& folder, const std::string& from, const std::string& to) {
  const std::string path = folder + "/" + from;
  if (std::rename(path.c_str(), (folder + "/" + to).c_str()) != 0 && errno != ENOENT)
    return Error{ErrorCode::kIo, fmt::format("renaming {}: {}", path, std::strerror(errno))};
  return sync_path(folder);
}

Status remove_in_folder(const std::string& folder, const std::string& name) {
  const std::string path = folder + "/" + name;
  if (unlink(path.c_str()) != 0 && errno != ENOENT)
    return Error{ErrorCode::kIo, fmt::format("removing {}: {}", path, std::strerror(errno))};
  return sync_path(folder);
}

}  // namespace hermite::server
