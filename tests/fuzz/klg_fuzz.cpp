// .klg files. Input: the file. The camera is given, as small as cameras may be: else only images of
// 640x480 would be read.
#include "tests/fuzz/recording_file.h"

extern "C" int LLVMFuzzerTestOneInput(const std::uint8_t* data, std::size_t size) {
  using namespace hermite;
  const fuzz::MemoryFile file(data, size);
  static_cast<void>(dataset::probe_klg(file.path()));
  fuzz::check_recording(dataset::open_klg(file.path(), Camera{64, 64, 50, 50, 32, 32, 1000}));
  fuzz::check_recording(dataset::open_klg(file.path(), std::nullopt));
  return 0;
}
