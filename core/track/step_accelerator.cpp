#include "core/track/step_accelerator.h"

namespace hermite {

namespace {

// Beyond it two steps tell nothing of the next: they hardly differ, or one is chance.
constexpr double kFarthest = 3;

}  // namespace

Vector6d StepAccelerator::next(const Vector6d& proposed, const Matrix6d& displacement) {
  Vector6d taken = proposed;
  if (has_last_) {
    const Vector6d change = proposed - last_proposed_, weighed = displacement * change;
    const double change2 = change.dot(weighed);
    const double share = change2 > 0 ? proposed.dot(weighed) / change2 : 0;
    const Vector6d foreseen = proposed - share * (last_taken_ + change);
    const double foreseen2 = foreseen.dot(displacement * foreseen), proposed2 = proposed.dot(displacement * proposed);
    if (foreseen.allFinite() && foreseen2 <= kFarthest * kFarthest * proposed2) taken = foreseen;
  }
  has_last_ = true;
  last_proposed_ = proposed;
  last_taken_ = taken;
  return taken;
}

}  // namespace hermite
