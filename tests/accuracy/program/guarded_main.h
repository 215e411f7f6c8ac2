// How the programs that measure accuracy begin and end.
#pragma once

#include <exception>
#include <iostream>

namespace hermite {

// Returns what `run` returns, or 1 when it throws; the error is then on standard error behind the
// program's name.
template <class Run>
int guarded_main(const char* program, const Run& run) {
  try {
    return run();
  } catch (const std::exception& error) {
    std::cerr << program << ": " << error.what() << "\n";
    return 1;
  }
}

}  // namespace hermite
