#include "server/store/set_aside_files.h"

#include <fmt/core.h>

#include <cerrno>
#include <chrono>
#include <cstdio>
#include <filesystem>
#include <system_error>

#include "core/base/check.h"
#include "server/store/errno_error.h"
#include "server/store/scan_id.h"

namespace hermite::server {

namespace {

namespace fs = std::filesystem;

fs::file_time_type file_time(std::int64_t unix_ms) {
  const std::chrono::sys_time<std::chrono::milliseconds> time{std::chrono::milliseconds(unix_ms)};
  return std::chrono::file_clock::from_sys(time);
}

}  // namespace

Result<std::string> SetAsideFiles::discard(const std::string& place) const {
  const std::string path = path_ + "/" + place;
  const std::string name = new_scan_id();
  if (rename(path.c_str(), (path_ + "/waste/" + name).c_str()) == 0) return name;
  if (errno == ENOENT) return std::string();
  return errno_error("removing " + path);
}

Result<std::string> SetAsideFiles::discard_scan(const std::string& scan_id) const {
  CHECK(is_scan_id(scan_id), "a path from something that is no scan id");
  return discard("scans/" + scan_id);
}

Result<std::string> SetAsideFiles::discard_upload(const std::string& upload_id) const {
  CHECK(is_scan_id(upload_id), "a path from something that is no id");
  return discard("uploads/" + upload_id);
}

Result<std::string> SetAsideFiles::discard_jobs() const { return discard("jobs"); }

std::vector<std::string> SetAsideFiles::waste() const {
  std::vector<std::string> names;
  std::error_code error;
  for (fs::directory_iterator entry(path_ + "/waste", error), end; !error && entry != end;
       entry.increment(error))
    names.push_back(entry->path().filename());
  return names;
}

Status SetAsideFiles::remove_waste(const std::string& name) const {
  CHECK(is_scan_id(name), "a path from something that is no name of waste");
  std::error_code error;
  fs::remove_all(path_ + "/waste/" + name, error);
  if (error)
    return Error{ErrorCode::kIo,
                 fmt::format("removing {}/waste/{}: {}", path_, name, error.message())};
  return Done{};
}

Status SetAsideFiles::lose(const std::string& place, std::int64_t now_ms) const {
  const std::string lost = path_ + "/lost/" + place;
  std::error_code error;
  // A rename would replace an empty folder or a file.
  if (fs::exists(fs::symlink_status(lost, error)))
    return Error{ErrorCode::kIo, lost + " is there already"};
  fs::rename(path_ + "/" + place, lost, error);
  if (!error) fs::last_write_time(lost, file_time(now_ms), error);
  if (error)
    return Error{ErrorCode::kIo, fmt::format("moving {} to lost/: {}", place, error.message())};
  return Done{};
}

Status SetAsideFiles::lose_scan(const std::string& scan_id, std::int64_t now_ms) const {
  CHECK(is_scan_id(scan_id), "a path from something that is no scan id");
  return lose("scans/" + scan_id, now_ms);
}

Status SetAsideFiles::lose_upload(const std::string& upload_id, std::int64_t now_ms) const {
  CHECK(is_scan_id(upload_id), "a path from something that is no id");
  return lose("uploads/" + upload_id, now_ms);
}

std::vector<std::string> SetAsideFiles::discard_lost(std::int64_t lost_before_ms) const {
  std::vector<std::string> discarded;
  for (const std::string kind : {"scans", "uploads"}) {
    std::vector<fs::path> old;
    std::error_code error;
    for (fs::directory_iterator entry(path_ + "/lost/" + kind, error), end; !error && entry != end;
         entry.increment(error))
      if (std::error_code gone;
          fs::last_write_time(entry->path(), gone) < file_time(lost_before_ms) && !gone)
        old.push_back(entry->path());
    for (const fs::path& path : old) {
      const std::string place = "lost/" + kind + "/" + path.filename().string();
      if (discard(place).ok()) discarded.push_back(place);
    }
  }
  return discarded;
}

}  // namespace hermite::server
