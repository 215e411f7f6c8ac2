#include "server/s3/remote_blobs.h"

#include <fmt/core.h>

#include <algorithm>
#include <chrono>
#include <fstream>
#include <system_error>

#include "core/output/ply.h"
#include "server/store/scan_id.h"

namespace hermite::server {

namespace {

constexpr std::chrono::seconds kPause(3);  // between attempts while S3 does not answer

}  // namespace

Result<std::set<BlobKey>> read_removals(const std::string& path) {
  std::ifstream file(path);
  std::set<BlobKey> removals;
  for (std::string scan_id, name; file >> scan_id >> name;) {
    if (!is_scan_id(scan_id) || !is_blob_name(name))
      return Error{
          ErrorCode::kCorruptData,
          fmt::format("{} has a line that is no scan and name: '{} {}'", path, scan_id, name)};
    removals.insert({scan_id, name});
  }
  return removals;
}

RemoteBlobs::RemoteBlobs(S3Options options, LocalBlobs local)
    : s3_(std::move(options)), local_(std::move(local)) {}

RemoteBlobs::~RemoteBlobs() {
  {
    const std::lock_guard lock(mutex_);
    stopping_ = true;
  }
  s3_.stop();
  changed_.notify_all();
  if (thread_.joinable()) thread_.join();
}

Status RemoteBlobs::load() {
  Result<std::set<Key>> removals = read_removals(local_.removals_path);
  if (!removals.ok()) return removals.error();
  removals_ = *std::move(removals);
  const Status listed = s3_.list_all(
      [this](const std::string& scan_id, const std::string& name, const StoredBlob& blob) {
        if (!removals_.contains({scan_id, name})) known_[scan_id][name] = blob;
      });
  if (!listed.ok()) return listed;
  thread_ = std::thread([this] { work(); });
  return Done{};
}

Status RemoteBlobs::write_removals(const std::set<Key>& removals) const {
  std::string text;
  for (const auto& [scan_id, name] : removals) text += fmt::format("{} {}\n", scan_id, name);
  return output::write_file_atomically(local_.removals_path, text);
}

Result<StoredBlob> RemoteBlobs::find(const std::string& scan_id, const std::string& name) const {
  const std::lock_guard lock(mutex_);
  const auto scan = known_.find(scan_id);
  if (scan != known_.end())
    if (const auto blob = scan->second.find(name); blob != scan->second.end()) return blob->second;
  return Error{ErrorCode::kNotFound, fmt::format("there is no {} of scan {}", name, scan_id)};
}

// What is put again is not to be removed any more; a removal that is being made comes first.
Status RemoteBlobs::take_back_removal(const Key& key) {
  std::unique_lock lock(mutex_);
  changed_.wait(lock, [&] { return removing_ != key || stopping_; });
  if (!removals_.contains(key)) return Done{};
  std::set<Key> others = removals_;
  others.erase(key);
  if (Status status = write_removals(others); !status.ok()) return status;
  removals_ = std::move(others);
  return Done{};
}

Status RemoteBlobs::put(const std::string& scan_id, const std::string& name,
                        const std::string& bytes) {
  if (is_local(name)) return local_.blobs.put(scan_id, name, bytes);
  if (Status status = take_back_removal({scan_id, name}); !status.ok()) return status;
  const Result<StoredBlob> stored = s3_.put_blob(scan_id, name, bytes);
  const std::lock_guard lock(mutex_);
  if (stored.ok())
    known_[scan_id][name] = *stored;
  else if (stored.error().code == ErrorCode::kIo)
    unsure_.insert({scan_id, name});
  changed_.notify_all();
  return stored.ok() ? Status(Done{}) : Status(stored.error());
}

Result<std::string> RemoteBlobs::read(const std::string& scan_id, const std::string& name,
                                      std::uint64_t offset, std::size_t max_bytes) {
  if (is_local(name)) return local_.blobs.read(scan_id, name, offset, max_bytes);
  // OpenStack Swift with a single replica says for a moment that an object is not there while it is
  // replaced.
  constexpr int kTries = 4;
  for (int tried = 1;; ++tried) {
    if (const Result<StoredBlob> blob = find(scan_id, name); !blob.ok()) return blob.error();
    Result<std::string> bytes = s3_.read(scan_id, name, offset, max_bytes);
    if (bytes.ok() || bytes.error().code != ErrorCode::kNotFound || !find(scan_id, name).ok())
      return bytes;
    if (tried == kTries)
      return Error{ErrorCode::kIo, bytes.error().message +
                                       " any more: somebody else has removed it, or the bucket"};
  }
}

Result<std::uint64_t> RemoteBlobs::size_bytes(const std::string& scan_id, const std::string& name) {
  if (is_local(name)) return local_.blobs.size_bytes(scan_id, name);
  const Result<StoredBlob> blob = find(scan_id, name);
  return blob.ok() ? Result<std::uint64_t>(blob->size_bytes) : blob.error();
}

Result<std::string> RemoteBlobs::version(const std::string& scan_id, const std::string& name) {
  if (is_local(name)) return local_.blobs.version(scan_id, name);
  const Result<StoredBlob> blob = find(scan_id, name);
  return blob.ok() ? Result<std::string>(blob->version) : blob.error();
}

Result<std::vector<BlobInfo>> RemoteBlobs::list(const std::string& scan_id) {
  Result<std::vector<BlobInfo>> found = local_.blobs.list(scan_id);
  if (!found.ok()) return found;
  std::erase_if(*found, [this](const BlobInfo& info) { return !is_local(info.name); });
  {
    const std::lock_guard lock(mutex_);
    if (const auto scan = known_.find(scan_id); scan != known_.end())
      for (const auto& [name, blob] : scan->second) found->push_back({name, blob.size_bytes});
  }
  std::sort(found->begin(), found->end(),
            [](const BlobInfo& a, const BlobInfo& b) { return a.name < b.name; });
  return found;
}

Status RemoteBlobs::remove_all(const std::set<Key>& keys) {
  const std::lock_guard lock(mutex_);
  std::set<Key> removals = removals_;
  for (const auto& [scan_id, name] : keys) {
    const auto scan = known_.find(scan_id);
    if ((scan != known_.end() && scan->second.contains(name)) || unsure_.contains({scan_id, name}))
      removals.insert({scan_id, name});
  }
  if (removals.size() == removals_.size()) return Done{};
  if (Status status = write_removals(removals); !status.ok()) return status;
  removals_ = std::move(removals);
  for (const Key& key : keys) {
    unsure_.erase(key);
    const auto scan = known_.find(key.first);
    if (scan == known_.end()) continue;
    scan->second.erase(key.second);
    if (scan->second.empty()) known_.erase(scan);
  }
  changed_.notify_all();
  return Done{};
}

Status RemoteBlobs::remove(const std::string& scan_id) {
  std::set<Key> keys;
  {
    const std::lock_guard lock(mutex_);
    if (const auto scan = known_.find(scan_id); scan != known_.end())
      for (const auto& [name, blob] : scan->second) keys.insert({scan_id, name});
    for (const Key& key : unsure_)
      if (key.first == scan_id) keys.insert(key);
  }
  for (const std::string& name : local_.names)
    if (Status status = local_.blobs.remove(scan_id, name); !status.ok()) return status;
  return remove_all(keys);
}

Status RemoteBlobs::remove(const std::string& scan_id, const std::string& name) {
  if (is_local(name)) return local_.blobs.remove(scan_id, name);
  return remove_all({{scan_id, name}});
}

Status RemoteBlobs::availability() { return s3_.availability(); }

void RemoteBlobs::add_sizes(std::map<std::string, std::uint64_t>& sizes) const {
  const std::lock_guard lock(mutex_);
  for (const auto& [scan_id, blobs] : known_)
    for (const auto& [name, blob] : blobs) sizes[scan_id] += blob.size_bytes;
}

std::size_t RemoteBlobs::removal_count() const {
  const std::lock_guard lock(mutex_);
  return removals_.size();
}

void RemoteBlobs::work() {
  std::unique_lock lock(mutex_);
  while (!stopping_) {
    if (work_once(lock)) continue;
    changed_.wait_for(lock, kPause, [this] { return stopping_; });
  }
}

// Returns true if there may be more to do at once. Waits if there is nothing.
bool RemoteBlobs::work_once(std::unique_lock<std::mutex>& lock) {
  if (!removals_.empty()) return remove_one(lock);
  if (!unsure_.empty()) return ask_again(lock);
  if (s3_.availability().ok()) {
    changed_.wait_for(lock, kPause);  // a failed read tells nobody: look now and then
    return true;
  }
  lock.unlock();
  const bool answers = s3_.ask().ok();
  lock.lock();
  return answers;
}

bool RemoteBlobs::remove_one(std::unique_lock<std::mutex>& lock) {
  removing_ = *removals_.begin();
  const Key key = removing_;
  lock.unlock();
  const Status removed = s3_.remove(key.first, key.second);
  lock.lock();
  removing_ = {};
  changed_.notify_all();
  if (!removed.ok()) return false;
  std::set<Key> others = removals_;
  others.erase(key);
  if (!write_removals(others).ok()) return false;  // it is removed again, which does no harm
  removals_ = std::move(others);
  return true;
}

// What is there, after a put that may or may not have succeeded.
bool RemoteBlobs::ask_again(std::unique_lock<std::mutex>& lock) {
  const Key key = *unsure_.begin();
  lock.unlock();
  const Result<StoredBlob> blob = s3_.find(key.first, key.second);
  lock.lock();
  if (!blob.ok() && blob.error().code != ErrorCode::kNotFound) return false;
  if (unsure_.erase(key) == 0) return true;  // it was removed meanwhile
  if (blob.ok()) known_[key.first][key.second] = *blob;
  return true;
}

}  // namespace hermite::server
