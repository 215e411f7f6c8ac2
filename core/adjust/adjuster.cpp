#include "core/adjust/adjuster.h"

#include <chrono>
#include <utility>

namespace hermite::adjust {

void Adjuster::start(BundleProblem problem, const BundleOptions& options) {
  CHECK(!busy(), "an adjuster was started before its last result was taken");
  std::packaged_task<Result<BundleSolution>(std::stop_token)> job(
      [problem = std::move(problem), options](std::stop_token stop) {
        return adjust(problem, options, std::move(stop));
      });
  result_ = job.get_future();
  // The assignment joins the previous job's thread, which has already finished its work.
  worker_ =
      std::jthread([job = std::move(job)](std::stop_token stop) mutable { job(std::move(stop)); });
}

std::optional<Result<BundleSolution>> Adjuster::poll() {
  if (!busy() || result_.wait_for(std::chrono::seconds(0)) != std::future_status::ready)
    return std::nullopt;
  return result_.get();
}

Result<BundleSolution> Adjuster::wait() {
  CHECK(busy(), "wait() was called without a running adjustment");
  return result_.get();
}

}  // namespace hermite::adjust
