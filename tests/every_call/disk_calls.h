// The calls by which this program and its libraries (SQLite's among them) change files, told to one who watches. The functions of libc are
// replaced by those in disk_calls.cpp, so that nothing between the code under test and the system is another one than in the server.
#pragma once

namespace hermite::test {

// One watches at a time, from its construction to its end; it is told by the threads that make the calls.
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
  // Before a call ("fdatasync"). 0: it is made; else it fails with that error number without having done anything.
  virtual int before(const char* call) = 0;
  // After an fsync or fdatasync of that descriptor that went well.
  virtual void synced(int descriptor) = 0;
};

}  // namespace hermite::test
