// What one linearisation of the odometry adds up over the pixels of a level (shaders/track/odometry.comp), as the systems that it stands
// for. Values, host only, any thread.
#pragma once

#include <array>

#include "core/track/normal_equations.h"
#include "shaders/shared/track.h"

namespace hermite {

// Over all workgroups, in the order of shaders/shared/track.h.
using OdometryTerms = std::array<double, shared::kOdometrySumCount>;

struct OdometrySums {
  OdometrySums() = default;
  // `all_pixels`: how many the level has.
  OdometrySums(const OdometryTerms& terms, double all_pixels);

  NormalEquations geometric;
  PhotometricSystem photometric;
  Matrix6d displacement = Matrix6d::Zero();  // of the geometric pairs
  // Mean squared sine between the normals: of the geometric pairs, weighted, and of all pairs near each other. Those that pass the gate of
  // angles are alike because they do, whatever their noise; those that do not may be edges or blur.
  double disagreement = 0, near_disagreement = 0;
  double geometric_base = 0;  // sum of the pairs' weights before residuals count
  double geometric_error_m2 = 0, geometric_count = 0, photometric_count = 0, surface_count = 0, pixel_count = 0;
  // Mean squares of the residuals as Student's t distribution has them, in scales squared; nothing where there are no pairs.
  double geometric_spread2 = 0, photometric_spread2 = 0;
  double photometric_squares = 0;  // sum of the weighted squared residuals
  // Of the squared gradients of the frame's picture, the share that the map shows, too; the rest is noise, blur, and what is not aligned.
  double gradient_share = 0;

  // The mean weight of a pair whose residual is one deviation, times that residual squared.
  double geometric_unit() const {
    return geometric_count > 0 ? geometric_base / geometric_count * geometric_error_m2 / geometric_count : 0;
  }
  double photometric_unit() const { return photometric_count > 0 ? photometric_squares / photometric_count : 0; }
};

}  // namespace hermite
