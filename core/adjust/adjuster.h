// Runs bundle adjustment on a helper thread, one job at a time: it takes a problem by value and
// returns a solution by value.
//
//   adjuster.start(problem, options);
//   ... frames go on ...
//   if (auto result = adjuster.poll()) apply(*result);
//
// All calls come from one thread, the scan's. The helper thread lives as long as its job.
#pragma once

#include <future>
#include <optional>
#include <thread>

#include "core/adjust/bundle.h"

namespace hermite::adjust {

class Adjuster {
 public:
  Adjuster() = default;
  // Asks a running job to stop, which it checks once per iteration, and joins its thread.
  ~Adjuster() = default;
  Adjuster(const Adjuster&) = delete;
  Adjuster& operator=(const Adjuster&) = delete;

  // A CHECK fails while a job is busy.
  void start(BundleProblem problem, const BundleOptions& options);
  // True from start() until poll() or wait() has returned the result.
  bool busy() const { return result_.valid(); }
  // Returns the result once, as soon as it is ready; nullopt before that or without a job. Never
  // blocks.
  std::optional<Result<BundleSolution>> poll();
  // Blocks until the result is ready. The iteration limits of the options bound the wait. A CHECK
  // fails without a job.
  Result<BundleSolution> wait();

 private:
  // Order matters: the worker stops and joins before the future it writes to is destroyed.
  std::future<Result<BundleSolution>> result_;
  std::jthread worker_;
};

}  // namespace hermite::adjust
