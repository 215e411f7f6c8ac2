#include "server/store/data_directory.h"

#include <fcntl.h>
#include <sys/file.h>
#include <sys/stat.h>
#include <sys/statvfs.h>
#include <unistd.h>

#include <algorithm>
#include <cerrno>
#include <chrono>
#include <cstdio>
#include <cstring>
#include <filesystem>
#include <limits>
#include <system_error>
#include <utility>

#include "core/base/check.h"
#include "core/base/sync_path.h"
#include "server/store/owned_descriptor.h"
#include "server/store/scan_id.h"

namespace hermite {

namespace {

constexpr int kTokenBytes = 32;
constexpr std::size_t kTokenDigits = 2 * kTokenBytes;

SetupError io_failure(const std::string& what) { return SetupError({ErrorCode::kIo, what + ": " + std::strerror(errno)}); }

bool is_token(const std::string& text) {
  return text.size() == kTokenDigits && text.find_first_not_of("0123456789abcdef") == std::string::npos;
}

// If the disk fills up meanwhile, no partial token is left that would make the next start fail.
std::string create_token(const std::string& path) {
  const std::string unfinished = path + ".new", token = random_hex(kTokenBytes), line = token + "\n";
  const OwnedDescriptor file(open(unfinished.c_str(), O_WRONLY | O_CREAT | O_TRUNC | O_CLOEXEC | O_NOFOLLOW, 0600));
  if (file.descriptor < 0) throw io_failure("creating " + unfinished);
  if (write(file.descriptor, line.data(), line.size()) != static_cast<ssize_t>(line.size()) || fsync(file.descriptor) != 0)
    throw io_failure("writing " + unfinished);
  if (rename(unfinished.c_str(), path.c_str()) != 0) throw io_failure("creating " + path);
  or_throw(sync_path(std::filesystem::path(path).parent_path()));
  return token;
}

// Reads at most `max_bytes`, without trailing line ends.
std::string read_line(const OwnedDescriptor& file, std::size_t max_bytes) {
  std::string text(max_bytes, '\0');
  const ssize_t count = pread(file.descriptor, text.data(), max_bytes, 0);
  text.resize(static_cast<std::size_t>(std::max<ssize_t>(count, 0)));
  while (!text.empty() && text.back() == '\n') text.pop_back();
  return text;
}

std::string read_or_create_token(const std::string& path) {
  const OwnedDescriptor file(open(path.c_str(), O_RDONLY | O_CLOEXEC | O_NOFOLLOW));
  if (file.descriptor < 0 && errno == ENOENT) return create_token(path);
  if (file.descriptor < 0) throw io_failure("opening " + path);
  const std::string token = read_line(file, kTokenDigits + 2);
  if (!is_token(token))
    throw SetupError({ErrorCode::kCorruptData, path + " holds no token of 64 hex digits; remove it and a new one is made"});
  if (fchmod(file.descriptor, 0600) != 0) throw io_failure("making " + path + " private");
  return token;
}

namespace fs = std::filesystem;

// Returns the size of all regular files, recursively. Files removed after they were listed do not count.
Result<std::uint64_t> bytes_below(const std::string& folder) {
  std::uint64_t total = 0;
  std::error_code error;
  for (fs::recursive_directory_iterator entry(folder, error), end; !error && entry != end; entry.increment(error)) {
    std::error_code gone;
    const std::uintmax_t bytes = fs::is_regular_file(entry->symlink_status(gone)) ? entry->file_size(gone) : 0;
    if (!gone) total += bytes;
  }
  // A scan may be removed meanwhile.
  if (error && error != std::errc::no_such_file_or_directory)
    return Error{ErrorCode::kIo, "adding up the files in " + folder + ": " + error.message()};
  return total;
}

Result<std::vector<std::string>> ids_in(const std::string& folder, fs::file_type type) {
  std::vector<std::string> ids;
  std::error_code error;
  for (fs::directory_iterator entry(folder, error), end; !error && entry != end; entry.increment(error)) {
    std::string name = entry->path().filename();
    std::error_code gone;
    if (is_scan_id(name) && entry->symlink_status(gone).type() == type) ids.push_back(std::move(name));
  }
  if (error) return Error{ErrorCode::kIo, "reading " + folder + ": " + error.message()};
  return ids;
}

fs::file_time_type file_time(std::int64_t unix_ms) {
  const std::chrono::sys_time<std::chrono::milliseconds> time{std::chrono::milliseconds(unix_ms)};
  return std::chrono::file_clock::from_sys(time);
}

// Locks an open file or folder; closes it if it cannot be locked.
int locked(int descriptor, const std::string& path) {
  if (descriptor < 0) throw io_failure("opening " + path);
  if (flock(descriptor, LOCK_EX | LOCK_NB) == 0) return descriptor;
  const bool taken = errno == EWOULDBLOCK;
  const SetupError failure = io_failure("locking " + path);
  close(descriptor);
  if (taken) throw SetupError({ErrorCode::kBusy, "another server holds " + path + "; give each server its own --data folder"});
  throw failure;
}

int take_lock(const std::string& path) {
  const int descriptor = locked(open(path.c_str(), O_RDWR | O_CREAT | O_CLOEXEC | O_NOFOLLOW, 0600), path);
  if (ftruncate(descriptor, 0) == 0) return descriptor;  // removes the address of an earlier server
  close(descriptor);
  throw io_failure("emptying " + path);
}

// Returns true if the folder did not exist. Its name, and those of missing parents, are durable.
bool create_with_parents(const std::string& wanted, const fs::path& folder) {
  const fs::path parent = folder.parent_path();
  std::error_code error;
  if (fs::is_directory(folder, error)) return false;
  create_with_parents(wanted, parent);
  fs::create_directory(folder, error);
  if (error) throw SetupError({ErrorCode::kIo, "creating the data folder " + wanted + ": " + error.message()});
  // Without permission to read the parent it cannot be synced; whoever starts a server in such a place has to accept
  // that.
  if (access(parent.c_str(), R_OK) == 0) or_throw(sync_path(parent));
  return true;
}

// Groups may have been given access on purpose, but all users of a machine never are.
void close_to_others(const std::string& path) {
  struct stat status {};
  if (stat(path.c_str(), &status) != 0) throw io_failure("looking at " + path);
  if ((status.st_mode & 0007) == 0 || chmod(path.c_str(), 0700) == 0) return;
  throw SetupError({ErrorCode::kIo, path + " is open to other users, and is not ours to close (" + std::strerror(errno) +
                                        "): chown it to the user of the server, or chmod o= it"});
}

Result<Inodes> inodes_at(const std::string& path) {
  struct statvfs status {};
  if (statvfs(path.c_str(), &status) != 0) return Error{ErrorCode::kIo, "asking for the inodes of " + path + ": " + std::strerror(errno)};
  constexpr std::uint64_t kMany = std::numeric_limits<std::uint64_t>::max();
  if (status.f_files == 0) return Inodes{kMany, kMany};
  return Inodes{status.f_favail, status.f_files};
}

}  // namespace

DataDirectory::DataDirectory(const std::string& path) : path_(path) {
  if (create_with_parents(path_, (fs::absolute(path_) / "").parent_path())) chmod(path_.c_str(), 0700);
  close_to_others(path_);
  if (std::error_code error; fs::exists(path_ + "/" + kRestoreMark, error))
    throw SetupError(
        {ErrorCode::kCorruptData, "a restore into " + path_ + " was cut off: `hermite restore` into it again, which begins anew"});
  lock_file_ = take_lock(path_ + "/lock");
  try {
    locked_folder_ = locked(open(path_.c_str(), O_RDONLY | O_DIRECTORY | O_CLOEXEC), path_);
    for (const char* folder : {"/scans", "/waste", "/lost", "/lost/scans", "/lost/uploads", "/uploads"})
      if (mkdir((path_ + folder).c_str(), 0700) != 0 && errno != EEXIST) throw io_failure("creating " + path_ + folder);
    or_throw(discard(path_ + "/jobs"));
    if (mkdir((path_ + "/jobs").c_str(), 0700) != 0) throw io_failure("creating " + path_ + "/jobs");
    for (const char* folder : {"", "/lost"}) or_throw(sync_path(path_ + folder));
    token_ = read_or_create_token(path_ + "/token");
  } catch (...) {
    // No destructor runs when a constructor throws.
    close(lock_file_);
    if (locked_folder_ >= 0) close(locked_folder_);
    throw;
  }
}

DataDirectory::~DataDirectory() {
  close(lock_file_);
  close(locked_folder_);
}

std::string DataDirectory::scan_folder(const std::string& scan_id) const {
  CHECK(is_scan_id(scan_id), "a path from something that is no scan id");
  return path_ + "/scans/" + scan_id;
}

Status DataDirectory::create_scan_folder(const std::string& scan_id) const {
  const std::string folder = scan_folder(scan_id);
  if (mkdir(folder.c_str(), 0700) != 0) return Error{ErrorCode::kIo, "creating " + folder + ": " + std::strerror(errno)};
  return Done{};
}

Status DataDirectory::remove_scan_folder(const std::string& scan_id) const {
  std::error_code error;
  std::filesystem::remove_all(scan_folder(scan_id), error);
  if (error) return Error{ErrorCode::kIo, "removing the files of scan " + scan_id + ": " + error.message()};
  return Done{};
}

Status DataDirectory::publish_address(const std::string& url) const {
  const std::string line = url + "\n";
  if (pwrite(lock_file_, line.data(), line.size(), 0) != static_cast<ssize_t>(line.size()))
    return Error{ErrorCode::kIo, "writing " + path_ + "/lock: " + std::strerror(errno)};
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

Result<std::vector<std::string>> DataDirectory::scan_ids() const { return ids_in(scans_folder(), fs::file_type::directory); }

Result<std::vector<std::string>> DataDirectory::logged_scan_ids() const {
  Result<std::vector<std::string>> ids = scan_ids();
  if (ids.ok())
    std::erase_if(*ids, [this](const std::string& id) {
      std::error_code gone;
      return !fs::is_directory(fs::symlink_status(log_folder(id), gone));
    });
  return ids;
}

Result<std::vector<std::string>> DataDirectory::upload_ids() const { return ids_in(uploads_folder(), fs::file_type::regular); }

int DataDirectory::remove_unfinished_files(const std::string& scan_id) const {
  int count = 0;
  std::error_code error;
  std::vector<fs::path> found;
  for (fs::directory_iterator entry(scan_folder(scan_id), error), end; !error && entry != end; entry.increment(error))
    if (std::error_code gone; entry->path().extension() == ".tmp" && fs::is_regular_file(entry->symlink_status(gone)))
      found.push_back(entry->path());
  for (const fs::path& path : found) count += fs::remove(path, error) ? 1 : 0;
  return count;
}

Result<std::string> DataDirectory::discard(const std::string& path) const {
  const std::string name = new_scan_id();
  if (rename(path.c_str(), (path_ + "/waste/" + name).c_str()) == 0) return name;
  if (errno == ENOENT) return std::string();
  return Error{ErrorCode::kIo, "removing " + path + ": " + std::strerror(errno)};
}

Result<std::string> DataDirectory::discard_scan(const std::string& scan_id) const { return discard(scan_folder(scan_id)); }

Result<std::string> DataDirectory::discard_upload(const std::string& upload_id) const { return discard(upload_path(upload_id)); }

std::vector<std::string> DataDirectory::waste() const {
  std::vector<std::string> names;
  std::error_code error;
  for (fs::directory_iterator entry(path_ + "/waste", error), end; !error && entry != end; entry.increment(error))
    names.push_back(entry->path().filename());
  return names;
}

Status DataDirectory::remove_waste(const std::string& name) const {
  CHECK(is_scan_id(name), "a path from something that is no name of waste");
  std::error_code error;
  fs::remove_all(path_ + "/waste/" + name, error);
  if (error) return Error{ErrorCode::kIo, "removing " + path_ + "/waste/" + name + ": " + error.message()};
  return Done{};
}

Status DataDirectory::lose(const std::string& place, std::int64_t now_ms) const {
  const std::string lost = path_ + "/lost/" + place;
  std::error_code error;
  // A rename would replace an empty folder or a file.
  if (fs::exists(fs::symlink_status(lost, error))) return Error{ErrorCode::kIo, lost + " is there already"};
  fs::rename(path_ + "/" + place, lost, error);
  if (!error) fs::last_write_time(lost, file_time(now_ms), error);
  if (error) return Error{ErrorCode::kIo, "moving " + place + " to lost/: " + error.message()};
  return Done{};
}

Status DataDirectory::lose_scan(const std::string& scan_id, std::int64_t now_ms) const {
  CHECK(is_scan_id(scan_id), "a path from something that is no scan id");
  return lose("scans/" + scan_id, now_ms);
}

Status DataDirectory::lose_upload(const std::string& upload_id, std::int64_t now_ms) const {
  CHECK(is_scan_id(upload_id), "a path from something that is no id");
  return lose("uploads/" + upload_id, now_ms);
}

std::vector<std::string> DataDirectory::discard_lost(std::int64_t lost_before_ms) const {
  std::vector<std::string> discarded;
  for (const std::string kind : {"scans", "uploads"}) {
    std::vector<fs::path> old;
    std::error_code error;
    for (fs::directory_iterator entry(path_ + "/lost/" + kind, error), end; !error && entry != end; entry.increment(error))
      if (std::error_code gone; fs::last_write_time(entry->path(), gone) < file_time(lost_before_ms) && !gone) old.push_back(entry->path());
    for (const fs::path& path : old)
      if (discard(path).ok()) discarded.push_back("lost/" + kind + "/" + path.filename().string());
  }
  return discarded;
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
  if (mkdir(folder.c_str(), 0700) != 0 && errno != EEXIST) return Error{ErrorCode::kIo, "creating " + folder + ": " + std::strerror(errno)};
  return Done{};
}

Status DataDirectory::remove_job_folder(const std::string& job_id) const {
  std::error_code error;
  std::filesystem::remove_all(job_folder(job_id), error);
  if (error) return Error{ErrorCode::kIo, "removing the files of job " + job_id + ": " + error.message()};
  return Done{};
}

Result<std::uint64_t> DataDirectory::free_disk_bytes() const { return free_bytes(path_); }

Result<Inodes> DataDirectory::inodes() const { return inodes_at(path_); }

Result<std::uint64_t> DataDirectory::disk_capacity_bytes() const {
  std::error_code error;
  const std::filesystem::space_info space = std::filesystem::space(path_, error);
  if (error) return Error{ErrorCode::kIo, "asking for the size of the disk of " + path_ + ": " + error.message()};
  return static_cast<std::uint64_t>(space.capacity - (space.free - space.available));  // blocks reserved for root are not available
}

Result<PublishedServer> published_server(const std::string& path) {
  constexpr std::size_t kMaxUrlBytes = 256;
  const OwnedDescriptor lock(open((path + "/lock").c_str(), O_RDONLY | O_CLOEXEC | O_NOFOLLOW));
  const OwnedDescriptor token(open((path + "/token").c_str(), O_RDONLY | O_CLOEXEC | O_NOFOLLOW));
  if (lock.descriptor < 0 || token.descriptor < 0)
    return Error{ErrorCode::kNotFound, "reading lock and token in " + path + ": " + std::strerror(errno)};
  PublishedServer server{read_line(lock, kMaxUrlBytes), read_line(token, kTokenDigits + 2)};
  if (server.url.empty() || !is_token(server.token))
    return Error{ErrorCode::kNotFound, "the program that uses " + path + " has not said where it listens"};
  return server;
}

Status DataDirectory::remove_log_folder(const std::string& scan_id) const {
  std::error_code error;
  std::filesystem::remove_all(log_folder(scan_id), error);
  if (error) return Error{ErrorCode::kIo, "removing the frames of scan " + scan_id + ": " + error.message()};
  return Done{};
}

Result<std::uint64_t> free_bytes(const std::string& path) {
  std::error_code error;
  const std::filesystem::space_info space = std::filesystem::space(path, error);
  if (error) return Error{ErrorCode::kIo, "asking for the free space of " + path + ": " + error.message()};
  const Result<Inodes> inodes = inodes_at(path);
  if (!inodes.ok()) return inodes.error();
  const bool has_many = inodes->free > space.available / kBytesPerInode;
  return has_many ? static_cast<std::uint64_t>(space.available) : inodes->free * kBytesPerInode;
}

Status check_takes_files(const std::string& data_folder) {
  const std::string path = data_folder + "/probe";
  const OwnedDescriptor file(open(path.c_str(), O_WRONLY | O_CREAT | O_CLOEXEC | O_NOFOLLOW, 0600));
  if (file.descriptor < 0 || unlink(path.c_str()) != 0)
    return Error{ErrorCode::kIo, "making a file in " + data_folder + ": " + std::strerror(errno)};
  return Done{};
}

}  // namespace hermite
