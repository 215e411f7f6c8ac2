#include "server/store/data_directory.h"

#include <fmt/core.h>
#include <sys/stat.h>
#include <unistd.h>

#include <cerrno>
#include <cstring>
#include <filesystem>
#include <system_error>
#include <utility>

#include "core/base/check.h"
#include "core/base/sync_path.h"
#include "server/store/errno_error.h"
#include "server/store/first_token.h"
#include "server/store/scan_id.h"

namespace hermite::server {

namespace {

namespace fs = std::filesystem;

// Returns the size of all regular files, recursively. Files removed after they were listed do not
// count.
Result<std::uint64_t> bytes_below(const std::string& folder) {
  std::uint64_t total = 0;
  std::error_code error;
  for (fs::recursive_directory_iterator entry(folder, error), end; !error && entry != end;
       entry.increment(error)) {
    std::error_code gone;
    const std::uintmax_t bytes =
        fs::is_regular_file(entry->symlink_status(gone)) ? entry->file_size(gone) : 0;
    if (!gone) total += bytes;
  }
  // A scan may be removed meanwhile.
  if (error && error != std::errc::no_such_file_or_directory)
    return Error{ErrorCode::kIo,
                 fmt::format("adding up the files in {}: {}", folder, error.message())};
  return total;
}

Result<std::vector<std::string>> ids_in(const std::string& folder, fs::file_type type) {
  std::vector<std::string> ids;
  std::error_code error;
  for (fs::directory_iterator entry(folder, error), end; !error && entry != end;
       entry.increment(error)) {
    std::string name = entry->path().filename();
    std::error_code gone;
    if (is_scan_id(name) && entry->symlink_status(gone).type() == type)
      ids.push_back(std::move(name));
  }
  if (error) return Error{ErrorCode::kIo, fmt::format("reading {}: {}", folder, error.message())};
  return ids;
}

// Returns true if the folder did not exist. Its name, and those of missing parents, are durable.
bool create_with_parents(const std::string& wanted, const fs::path& folder) {
  const fs::path parent = folder.parent_path();
  std::error_code error;
  if (fs::is_directory(folder, error)) return false;
  create_with_parents(wanted, parent);
  fs::create_directory(folder, error);
  if (error)
    throw SetupError(
        {ErrorCode::kIo, fmt::format("creating the data folder {}: {}", wanted, error.message())});
  // Without permission to read the parent it cannot be synced; whoever starts a server in such a
  // place has to accept that.
  if (access(parent.c_str(), R_OK) == 0) or_throw(sync_path(parent));
  return true;
}

// Groups may have been given access on purpose, but all users of a machine never are.
void close_to_others(const std::string& path) {
  struct stat status {};
  if (stat(path.c_str(), &status) != 0) throw SetupError(errno_error("looking at " + path));
  if ((status.st_mode & 0007) == 0 || chmod(path.c_str(), 0700) == 0) return;
  throw SetupError(
      {ErrorCode::kIo, fmt::format("{} is open to other users, and is not ours to close ({}): "
                                   "chown it to the user of the server, or chmod o= it",
                                   path, std::strerror(errno))});
}

// Creates the folder of a server, or looks whether a server may use it as it is. Returns its path.
const std::string& prepared(const std::string& path) {
  if (create_with_parents(path, (fs::absolute(path) / "").parent_path())) chmod(path.c_str(), 0700);
  close_to_others(path);
  if (std::error_code error; fs::exists(path + "/" + kRestoreMark, error))
    throw SetupError(
        {ErrorCode::kCorruptData,
         fmt::format(
             "a restore into {} was cut off: `hermite restore` into it again, which begins anew",
             path)});
  return path;
}

}  // namespace

DataDirectory::DataDirectory(const std::string& path)
    : path_(path), lock_(prepared(path_)), set_aside_(path_) {
  for (const char* folder :
       {"/scans", "/waste", "/lost", "/lost/scans", "/lost/uploads", "/uploads"})
    if (mkdir((path_ + folder).c_str(), 0700) != 0 && errno != EEXIST)
      throw SetupError(errno_error(fmt::format("creating {}{}", path_, folder)));
  or_throw(set_aside_.discard_jobs());
  if (mkdir((path_ + "/jobs").c_str(), 0700) != 0)
    throw SetupError(errno_error(fmt::format("creating {}/jobs", path_)));
  for (const char* folder : {"", "/lost"}) or_throw(sync_path(path_ + folder));
  token_ = read_or_create_first_token(path_ + "/token");
}

std::string DataDirectory::scan_folder(const std::string& scan_id) const {
  CHECK(is_scan_id(scan_id), "a path from something that is no scan id");
  return path_ + "/scans/" + scan_id;
}

Status DataDirectory::create_scan_folder(const std::string& scan_id) const {
  const std::string folder = scan_folder(scan_id);
  if (mkdir(folder.c_str(), 0700) != 0) return errno_error("creating " + folder);
  return Done{};
}

Status DataDirectory::remove_scan_folder(const std::string& scan_id) const {
  std::error_code error;
  std::filesystem::remove_all(scan_folder(scan_id), error);
  if (error)
    return Error{ErrorCode::kIo,
                 fmt::format("removing the files of scan {}: {}", scan_id, error.message())};
  return Done{};
}

Status DataDirectory::remove_log_folder(const std::string& scan_id) const {
  std::error_code error;
  std::filesystem::remove_all(log_folder(scan_id), error);
  if (error)
    return Error{ErrorCode::kIo,
                 fmt::format("removing the frames of scan {}: {}", scan_id, error.message())};
  return Done{};
}

Result<std::map<std::string, std::uint64_t>> DataDirectory::scan_sizes() const {
  const Result<std::vector<std::string>> ids = scan_ids();
  if (!ids.ok()) return ids.error();
  std::map<std::string, std::uint64_t> sizes;
  for (const std::string& id : *ids) {
    const Result<std::uint64_t> bytes = bytes_below(scan_folder(id));
    if (!bytes.ok()) return bytes.error();
    sizes[id] = *bytes;
  }
  return sizes;
}

Result<std::uint64_t> DataDirectory::uploads_bytes(const std::string& except_upload_id) const {
  const Result<std::vector<std::string>> ids = upload_ids();
  if (!ids.ok()) return ids.error();
  std::uint64_t total = 0;
  for (const std::string& id : *ids) {
    std::error_code gone;
    const std::uintmax_t bytes = id == except_upload_id ? 0 : fs::file_size(upload_path(id), gone);
    if (!gone) total += bytes;
  }
  return total;
}

Result<std::vector<std::string>> DataDirectory::scan_ids() const {
  return ids_in(scans_folder(), fs::file_type::directory);
}

Result<std::vector<std::string>> DataDirectory::logged_scan_ids() const {
  Result<std::vector<std::string>> ids = scan_ids();
  if (ids.ok())
    std::erase_if(*ids, [this](const std::string& id) {
      std::error_code gone;
      return !fs::is_directory(fs::symlink_status(log_folder(id), gone));
    });
  return ids;
}

Result<std::vector<std::string>> DataDirectory::upload_ids() const {
  return ids_in(uploads_folder(), fs::file_type::regular);
}

int DataDirectory::remove_unfinished_files(const std::string& scan_id) const {
  int count = 0;
  std::error_code error;
  std::vector<fs::path> found;
  for (fs::directory_iterator entry(scan_folder(scan_id), error), end; !error && entry != end;
       entry.increment(error))
    if (std::error_code gone;
        entry->path().extension() == ".tmp" && fs::is_regular_file(entry->symlink_status(gone)))
      found.push_back(entry->path());
  for (const fs::path& path : found) count += fs::remove(path, error) ? 1 : 0;
  return count;
}

std::string DataDirectory::upload_path(const std::string& upload_id) const {
  CHECK(is_scan_id(upload_id), "a path from something that is no id");
  return uploads_folder() + "/" + upload_id;
}

std::string DataDirectory::job_folder(const std::string& job_id) const {
  CHECK(is_scan_id(job_id), "a path from something that is no id");
  return path_ + "/jobs/" + job_id;
}

Status DataDirectory::create_job_folder(const std::string& job_id) const {
  const std::string folder = job_folder(job_id);
  if (mkdir(folder.c_str(), 0700) != 0 && errno != EEXIST) return errno_error("creating " + folder);
  return Done{};
}

Status DataDirectory::remove_job_folder(const std::string& job_id) const {
  std::error_code error;
  std::filesystem::remove_all(job_folder(job_id), error);
  if (error)
    return Error{ErrorCode::kIo,
                 fmt::format("removing the files of job {}: {}", job_id, error.message())};
  return Done{};
}

}  // namespace hermite::server
