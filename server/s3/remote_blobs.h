// Blobs in S3 for a server whose network thread may wait for no network. One server owns the prefix
// (remote_setup.h), so it knows what is there:
// - size_bytes, version, list and availability answer from memory. It is filled by load() and kept
//   up to date by put and remove.
// - remove takes effect at once; it is noted in a file on the own disk, and a thread removes the
//   objects, after a restart too.
// - put and read go to S3 and are called on threads that may wait. After a put that has failed, a
//   thread asks what is there.
// - While S3 does not answer, the thread asks every few seconds whether it does again.
// Checkpoints of running scans are of use to this machine only and are written often: they stay on
// the own disk (`local`).
#pragma once

#include <condition_variable>
#include <cstdint>
#include <map>
#include <mutex>
#include <set>
#include <string>
#include <thread>
#include <utility>
#include <vector>

#include "core/base/result.h"
#include "server/s3/s3_blobs.h"
#include "server/store/blobs.h"

namespace hermite::server {

using BlobKey = std::pair<std::string, std::string>;  // scan, name

// Reads the file of removals that have not been made yet; nothing if there is none. kCorruptData.
Result<std::set<BlobKey>> read_removals(const std::string& path);

struct LocalBlobs {
  Blobs& blobs;                 // on the own disk; outlives its user
  std::set<std::string> names;  // that stay there
  std::string removals_path;    // the file of removals that have not been made yet
};

// Thread-safe. The guarantees of Blobs hold while no other program changes what is below the
// prefix.
class RemoteBlobs : public Blobs {
 public:
  RemoteBlobs(S3Options options, LocalBlobs local);
  ~RemoteBlobs() override;  // no other call may be running

  // Reads which blobs there are, and goes on with removals that an earlier server has left. To be
  // called once, first. kIo, kCorruptData.
  Status load();

  Status put(const std::string& scan_id, const std::string& name,
             const std::string& bytes) override;
  Result<std::string> read(const std::string& scan_id, const std::string& name,
                           std::uint64_t offset, std::size_t max_bytes) override;
  Result<std::uint64_t> size_bytes(const std::string& scan_id, const std::string& name) override;
  Result<std::string> version(const std::string& scan_id, const std::string& name) override;
  // Includes those on the own disk.
  Result<std::vector<BlobInfo>> list(const std::string& scan_id) override;
  Status remove(const std::string& scan_id) override;
  Status remove(const std::string& scan_id, const std::string& name) override;
  Status availability() override;

  // Adds the bytes in S3 of every scan to `sizes`, by id.
  void add_sizes(std::map<std::string, std::uint64_t>& sizes) const;

  // Returns the number of removals that have not been made yet.
  std::size_t removal_count() const;

  S3Blobs& s3() { return s3_; }

 private:
  using Key = BlobKey;
  bool is_local(const std::string& name) const { return local_.names.contains(name); }
  Result<StoredBlob> find(const std::string& scan_id, const std::string& name) const;
  Status remove_all(const std::set<Key>& keys);
  Status write_removals(const std::set<Key>& removals) const;
  Status take_back_removal(const Key& key);
  void work();
  bool work_once(std::unique_lock<std::mutex>& lock);
  bool remove_one(std::unique_lock<std::mutex>& lock);
  bool ask_again(std::unique_lock<std::mutex>& lock);

  S3Blobs s3_;
  const LocalBlobs local_;
  mutable std::mutex mutex_;  // guards everything below; never held during a request
  std::condition_variable changed_;
  std::map<std::string, std::map<std::string, StoredBlob>> known_;  // by scan and name
  std::set<Key> removals_;                                          // noted, and not made yet
  std::set<Key> unsure_;                                            // whose last put has failed
  Key removing_;                                                    // by the thread, at present
  bool stopping_ = false;
  std::thread thread_;  // started by load()
};

}  // namespace hermite::server
