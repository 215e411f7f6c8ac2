// Bundle adjustment beside the scan: a helper thread that gets values and returns one value, one job at a time.
//
//   adjuster.start(problem, options);
//   ... frames go on ...
//   if (auto result = adjuster.poll()) apply(*result);
//
// Call all of it from one thread, that of the scan. The helper thread lives as long as its job.
#pragma once

#include <future>
#include <optional>
#include <thread>

#include "core/adjust/bundle.h"

namespace hermite {

class Adjuster {
 public:
  Adjuster() = default;
  // Tells a running job to give up, which it sees once an iteration, and waits for its thread.
  ~Adjuster() = default;
  Adjuster(const Adjuster&) = delete;
  Adjuster& operator=(const Adjuster&) = delete;

  // A CHECK fails while a job is busy.
  void start(BundleProblem problem, const BundleOptions& options);
  // From start() until poll() or wait() has handed the result over.
  bool busy() const { return result_.valid(); }
  // The result once it is there, and only once; nothing before that, or when no job was started. Never waits.
  std::optional<Result<BundleSolution>> poll();
  // The result; waits for it. It comes after at most the iterations of the options. A CHECK fails when there is no job.
  Result<BundleSolution> wait();

 private:
  // In this order: the worker stops and joins before the result that it writes to goes.
  std::future<Result<BundleSolution>> result_;
  std::jthread worker_;
};

}  // namespace hermite
