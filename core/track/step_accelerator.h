// Fewer steps to the same pose. Values, host only, one thread at a time.
#pragma once

#include "core/math/rigid3.h"

namespace hermite {

// Steps of a frame's alignment shrink by about the same share each time, since pairs are associated anew and their weights follow the
// residuals: three of four say what could be foreseen. Anderson acceleration with a memory of one step (Walker, Ni 2011, Anderson
// Acceleration for Fixed-Point Iterations; for point clouds Pavlov et al. 2018, AA-ICP) goes where the next one would propose nothing more,
// as far as the last two tell. What it converges to is the same.
class StepAccelerator {
 public:
  // The step to take where Gauss-Newton proposes `proposed`. `displacement`: of a twist x, x^T displacement x is how far it moves the
  // points, squared. At most thrice as far as is proposed; else, where steps do not shrink, and after reset(), what is proposed.
  Vector6d next(const Vector6d& proposed, const Matrix6d& displacement);

  // What follows is another problem: another level, other gates.
  void reset() { has_last_ = false; }

 private:
  bool has_last_ = false;
  Vector6d last_proposed_ = Vector6d::Zero(), last_taken_ = Vector6d::Zero();
};

}  // namespace hermite
