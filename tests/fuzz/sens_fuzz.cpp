// .sens files. Input: the file.
#include "tests/fuzz/recording_file.h"

extern "C" int LLVMFuzzerTestOneInput(const std::uint8_t* data, std::size_t size) {
  using namespace hermite;
  const fuzz::MemoryFile file(data, size);
  static_cast<void>(dataset::probe_sens(file.path()));
  fuzz::check_recording(dataset::open_sens(file.path(), std::nullopt));
  return 0;
}
