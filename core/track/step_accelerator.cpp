#include "core/track/step_accelerator.h"

namespace hermite::track {

namespace {

// A longer extrapolation is unreliable: the last two steps hardly differ, or one of them is chance.
constexpr double kFarthest = 3;

}  // namespace

Vector6d StepAccelerator::next(const Vector6d& proposed, const Matrix6d& displacement) {
  const auto square = [&displacement](const Vector6d& x) { return x.dot(displacement * x); };
  Vector6d taken = proposed;
  if (has_last_ && square(proposed) < square(last_proposed_)) {
    const Vector6d change = proposed - last_proposed_;
    const double change2 = square(change);
    const double share = change2 > 0 ? proposed.dot(displacement * change) / change2 : 0;
    const Vector6d foreseen = proposed - share * (last_taken_ + change);
    if (foreseen.allFinite() && square(foreseen) <= kFarthest * kFarthest * square(proposed))
      taken = foreseen;
  }
  has_last_ = true;
  last_proposed_ = proposed;
  last_taken_ = taken;
  return taken;
}

}  // namespace hermite::track
