// Power cuts: what a disk may hold after one, at every call that changes a file. While a PowerCut
// watches, it keeps account of which contents and which names in which folders were synced, as
// POSIX has it: a file's contents by fsync or fdatasync of the file, its name by fsync of the
// folder it is in, nothing by anything else. Before each call and at the end it takes images of
// what a cut at that moment leaves:
//
//   synced     nothing but what was synced: the least that a disk may keep
//   names      names as they are now (a journal of metadata is often written first), contents as
//              they were synced; what has grown since is there in its length, as zeros
//   half       names as they are now, of each file the first half of what was changed in it since
//              its last sync, and of its growth
//   all        everything: the process alone died
//
// What the code under test tells a client is noted beside (acknowledge()), so that each image has
// what was promised before it.
#pragma once

#include <sys/types.h>

#include <cstdint>
#include <map>
#include <mutex>
#include <set>
#include <string>
#include <vector>

#include "tests/every_call/disk_calls.h"

namespace hermite::test {

using Acknowledged = std::map<std::string, std::int64_t>;  // what: how much of it

// What is below a folder after a cut.
struct DiskImage {
  std::string when;  // "before fdatasync 12, synced"
  std::set<std::string> folders;
  // Bytes by path; both relative to the folder, parents before children in their order.
  std::map<std::string, std::string> files;
  Acknowledged acknowledged;

  void restore_into(const std::string& folder) const;  // which is there, and empty
};

class PowerCut : private DiskWatcher {
 public:
  explicit PowerCut(const std::string& folder);  // all that is in it was synced
  ~PowerCut();

  void acknowledge(const std::string& what, std::int64_t amount = 1);

  // Ends it. Those that differ, in the order of time.
  std::vector<DiskImage> end();
  int call_count() const { return call_count_; }

 private:
  enum class Loss { kSynced, kNames, kHalf, kAll };
  struct File {
    int descriptor = -1;  // holds the inode, so that its number is not used again
    bool is_folder = false;
    std::string synced;                           // contents
    std::map<std::string, ino_t> synced_entries;  // of a folder
  };

  int before(const DiskCall& call) override;
  void synced(int descriptor) override;
  ino_t meet(const std::string& path);
  void meet_all_in(const std::string& path);
  std::map<std::string, ino_t> entries_of(const std::string& path);
  void take_images(const std::string& when);
  void fill_image(DiskImage& into, Loss loss, ino_t folder, const std::string& relative);
  static std::string contents(const File& file, Loss loss);

  const std::string folder_;
  std::mutex mutex_;  // guards all below
  ino_t root_ = 0;
  std::map<ino_t, File> files_;  // all that were ever met
  Acknowledged acknowledged_;
  std::vector<DiskImage> images_;
  std::set<std::string> seen_;  // digests of them
  int call_count_ = 0;
};

}  // namespace hermite::test
