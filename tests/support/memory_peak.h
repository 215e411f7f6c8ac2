// How much memory a piece of work takes at its peak. Header only, Linux.
#pragma once

#include <cstddef>
#include <fstream>
#include <string>

namespace hermite::test {

// "VmRSS" or "VmHWM" of this process, in bytes; 0 when the kernel does not say.
inline std::size_t memory_bytes(const std::string& field) {
  std::ifstream status("/proc/self/status");
  for (std::string line; std::getline(status, line);) {
    if (line.starts_with(field + ":")) return std::stoull(line.substr(field.size() + 1)) * 1024;
  }
  return 0;
}

// Resident bytes that `work` added at its worst moment. Memory that is only reserved and never
// written does not show.
template <class Work>
std::size_t peak_growth_bytes(const Work& work) {
  std::ofstream("/proc/self/clear_refs") << "5";  // forget the peak so far
  const std::size_t before_bytes = memory_bytes("VmRSS");
  work();
  const std::size_t peak_bytes = memory_bytes("VmHWM");
  return peak_bytes > before_bytes ? peak_bytes - before_bytes : 0;
}

}  // namespace hermite::test
