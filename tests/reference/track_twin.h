// One Gauss-Newton step of the odometry on the CPU in double precision, with derivatives by
// differences instead of formulas (paper section 4). Pure functions.
#pragma once

#include <Eigen/Core>
#include <vector>

#include "core/math/rigid3.h"
#include "core/track/normal_equations.h"
#include "core/track/track_options.h"
#include "tests/support/surface_image.h"

namespace hermite::test {

struct TrackStep {
  track::NormalEquations geometric;
  track::PhotometricSystem photometric;
  // Sum of weight A^T A over the geometric pairs, A = d(exp(x) s)/dx.
  Matrix6d displacement = Matrix6d::Zero();
  double disagreement = 0;           // their weighted mean squared sine between the normals
  Vector6d step = Vector6d::Zero();  // translation, rotation: guess <- exp(step) guess
  double geometric_error_m2 = 0;
  int geometric_count = 0, photometric_count = 0, surface_count = 0;
};

// What is believed of residuals: scales of Student's t distribution, in standard deviations of the
// sensor and in grey values.
struct BelievedResiduals {
  double geometric_scale = 0, photometric_scale = 0;
};

// `gradients` are the frame's, grey values per pixel; `gradient_min` the least that counts at this
// level; projective association.
TrackStep track_step_twin(const SurfaceImage& frame, const std::vector<Eigen::Vector2d>& gradients,
                          const SurfaceImage& reference, const Rigid3& reference_from_camera,
                          const track::TrackOptions& options, const BelievedResiduals& believed,
                          double gradient_min);

}  // namespace hermite::test
