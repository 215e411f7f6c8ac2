// Runs a program of the system and takes what it prints, within limits of time and size. Blocks.
// Any thread. There is no shell, and the program gets no open file of this process.
#pragma once

#include <chrono>
#include <cstddef>
#include <string>
#include <vector>

#include "core/base/result.h"

namespace hermite::server {

struct ProcessLimits {
  std::chrono::milliseconds patience{20'000};  // then it is killed, with what it has started
  std::size_t max_bytes = std::size_t{4} * 1024 * 1024;  // of either stream
};

struct ProcessResult {
  int exit_status = 0;  // 128 and the signal's number more if a signal ended it
  std::string output, errors;
};

// `arguments` begins with the program, which is searched in PATH. Any exit status is a result.
// kNotFound: there is no such program. kUnavailable: it did not end in time. kTooLarge: it printed
// more than is taken. kIo.
Result<ProcessResult> run_process(const std::vector<std::string>& arguments,
                                  const ProcessLimits& limits = {});

}  // namespace hermite::server
