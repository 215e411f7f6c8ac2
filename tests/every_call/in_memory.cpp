// Faults are made here and not by a disk, so that the folders of this program's tests need none:
// the syncs of a real one take a second each beside a build. Elsewhere than in /dev/shm where
// TMPDIR says so.
#include <unistd.h>

#include <cstdlib>

namespace {

[[maybe_unused]] const int in_memory =
    access("/dev/shm", W_OK | X_OK) == 0 ? setenv("TMPDIR", "/dev/shm", 0) : 0;

}  // namespace
