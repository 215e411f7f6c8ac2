// A disk that says no at one call: while one is armed, the calls by which this program and its libraries (SQLite's among them) change files
// are counted, and the chosen one fails with the chosen error without having done anything. The functions of libc are replaced by those in
// failing_disk.cpp, so that nothing between the code under test and the system is another one than in the server.
#pragma once

#include <string>

namespace hermite::test {

// One is armed at a time, for all threads.
class FailingDisk {
 public:
  // `number`: of the call that fails, from 0. `and_all_after`: the disk stays as it is, as a full one does.
  FailingDisk(int number, int error, bool and_all_after);
  ~FailingDisk();  // disarms
  FailingDisk(const FailingDisk&) = delete;
  FailingDisk& operator=(const FailingDisk&) = delete;

  bool has_failed() const;
  std::string failed_call() const;  // "fdatasync"; empty: none was so far
};

}  // namespace hermite::test
