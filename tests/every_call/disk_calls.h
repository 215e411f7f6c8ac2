// The calls by which a program and its libraries (SQLite's among them) change files, told to one
// who watches. The functions of libc are replaced by those in disk_calls.cpp, so that nothing
// between the code under test and the system is another one than in the server. They are linked
// into a test's program, or loaded into any other one by LD_PRELOAD
// (tests/faults/failing_disk.cpp).
#pragma once

namespace hermite::test {

// What a call is about to change: the file of `descriptor`, or the one that has the name `path`.
struct DiskCall {
  const char* name;            // "fdatasync"
  int descriptor = -1;         // that is written to; -1: none, but
  const char* path = nullptr;  // the new name
};

// One watches at a time, from its construction to its end; it is told by the threads that make the
// calls.
class DiskWatcher {
 public:
  DiskWatcher(const DiskWatcher&) = delete;
  DiskWatcher& operator=(const DiskWatcher&) = delete;

 protected:
  DiskWatcher() = default;
  ~DiskWatcher() = default;
  void watch();    // from here on
  void unwatch();  // and no more; before the end of what before() and synced() use

 public:
  // Called before a call. 0: it is made; else it fails with that error number without having done
  // anything.
  virtual int before(const DiskCall& call) = 0;
  // After an fsync or fdatasync of that descriptor that went well.
  virtual void synced(int descriptor) = 0;
};

}  // namespace hermite::test
