// A library for LD_PRELOAD: in the program that it is loaded into, the calls of disk_calls.cpp that
// change something below one folder are counted, and from the chosen one on they fail. Settings are
// variables of the environment:
//
//   HERMITE_DISK_FOLDER   the folder, an absolute path without links; without it nothing is done
//   HERMITE_DISK_CALL     the number of the call that fails, from 1; 0: none
//   HERMITE_DISK_ERROR    its errno, a number
//   HERMITE_DISK_STAYS    1: all calls after it fail, too, as on a full disk; else only that one
//   HERMITE_DISK_REPORT   a file that gets a line for each call that is counted: "17 fdatasync
//                         hermite.db-wal", and " failed" behind the first one that fails; written
//                         at once, so that it has them also when the program is killed
#include <fcntl.h>
#include <unistd.h>

#include <array>
#include <atomic>
#include <climits>
#include <cstdio>
#include <cstdlib>
#include <string>
#include <string_view>

#include "tests/every_call/disk_calls.h"

namespace hermite::test {
namespace {

std::string setting(const char* name) {
  const char* const value = std::getenv(name);
  return value ? value : "";
}

// The name of the file that a call changes; empty: it has none, as a socket.
std::string path_of(const DiskCall& call) {
  if (call.path) return call.path;
  std::array<char, PATH_MAX> path;
  const ssize_t length = readlink(("/proc/self/fd/" + std::to_string(call.descriptor)).c_str(),
                                  path.data(), path.size());
  return length > 0 ? std::string(path.data(), static_cast<std::size_t>(length)) : "";
}

class PreloadedDisk : private DiskWatcher {
 public:
  explicit PreloadedDisk(const std::string& folder)
      : folder_(folder + "/"),
        failing_call_(std::atoi(setting("HERMITE_DISK_CALL").c_str())),
        error_(std::atoi(setting("HERMITE_DISK_ERROR").c_str())),
        stays_(setting("HERMITE_DISK_STAYS") == "1"),
        report_(open(setting("HERMITE_DISK_REPORT").c_str(),
                     O_WRONLY | O_CREAT | O_APPEND | O_CLOEXEC, 0600)) {
    watch();
  }

 private:
  int before(const DiskCall& call) override {
    const std::string path = path_of(call);
    if (!path.starts_with(folder_)) return 0;
    const int number = ++calls_;
    const bool fails =
        failing_call_ > 0 && (number == failing_call_ || (stays_ && number > failing_call_));
    // By libc's own write, which is not replaced.
    if (report_ >= 0)
      dprintf(report_, "%d %s %s%s\n", number, call.name, path.c_str() + folder_.size(),
              number == failing_call_ ? " failed" : "");
    return fails ? error_ : 0;
  }
  void synced(int) override {}

  const std::string folder_;
  const int failing_call_, error_;
  const bool stays_;
  const int report_;
  std::atomic<int> calls_ = 0;
};

// Never destroyed: the program writes until its end.
[[maybe_unused]] const PreloadedDisk* const preloaded = [] {
  const std::string folder = setting("HERMITE_DISK_FOLDER");
  return folder.empty() ? nullptr : new PreloadedDisk(folder);
}();

}  // namespace
}  // namespace hermite::test
