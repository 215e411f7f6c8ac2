// Acceleration of the alignment's convergence. Values on the host. One thread at a time.
#pragma once

#include "core/math/rigid3.h"

namespace hermite::track {

// The steps of a frame's alignment shrink by about the same factor each time, since pairs are
// associated anew and their weights follow the residuals; three of four steps are predictable.
// Anderson acceleration with a memory of one step (Walker, Ni 2011, Anderson Acceleration for
// Fixed-Point Iterations; for point clouds Pavlov et al. 2018, AA-ICP) extrapolates from the last
// two steps to where the next proposed step would vanish. It converges to the same pose.
class StepAccelerator {
 public:
  // Returns the step to take if Gauss-Newton proposes `proposed`. For a twist x, x^T displacement x
  // is the squared distance by which it moves the points. The step is at most three times the
  // proposed one; it is the proposed one if steps do not shrink, if the extrapolation is longer
  // than that, and after reset().
  Vector6d next(const Vector6d& proposed, const Matrix6d& displacement);

  // Call when the problem changes: another level, other gates.
  void reset() { has_last_ = false; }

 private:
  bool has_last_ = false;
  Vector6d last_proposed_ = Vector6d::Zero(), last_taken_ = Vector6d::Zero();
};

}  // namespace hermite::track
