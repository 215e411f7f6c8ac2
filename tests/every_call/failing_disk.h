// A disk that says no at one call: while one is armed, the calls that change files (disk_calls.h)
// are counted, and the chosen one fails with the chosen error without having done anything.
#pragma once

#include <atomic>
#include <string>

#include "tests/every_call/disk_calls.h"

namespace hermite::test {

// One is armed at a time, for all threads.
class FailingDisk : private DiskWatcher {
 public:
  // `number`: of the call that fails, from 0. `and_all_after`: the disk stays as it is, as a full
  // one does.
  FailingDisk(int number, int error, bool and_all_after)
      : calls_left_(number), error_(error), stays_(and_all_after) {
    watch();
  }
  ~FailingDisk() { unwatch(); }  // disarms

  std::string failed_call() const {  // "fdatasync"; empty: none was so far
    const char* const call = failed_.load();
    return call ? call : "";
  }

 private:
  int before(const DiskCall& call) override {
    const int left = calls_left_.fetch_sub(1);
    if (left > 0 || (left < 0 && !stays_)) return 0;
    const char* none = nullptr;
    failed_.compare_exchange_strong(none, call.name);
    return error_;
  }
  void synced(int) override {}

  std::atomic<int> calls_left_;  // before the one that fails
  const int error_;
  const bool stays_;
  std::atomic<const char*> failed_ = nullptr;
};

}  // namespace hermite::test
