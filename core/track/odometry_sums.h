// Sums of one linearisation of the odometry over the pixels of a level
// (shaders/track/odometry.comp), and the systems that they represent. Values on the host. Any
// thread.
#pragma once

#include <array>

#include "core/track/normal_equations.h"
#include "shaders/shared/track.h"

namespace hermite::track {

// Sums over all workgroups, in the order of shaders/shared/track.h.
using OdometryTerms = std::array<double, shared::kOdometrySumCount>;

struct OdometrySums {
  OdometrySums() = default;
  // `all_pixels` is the number of pixels of the level.
  OdometrySums(const OdometryTerms& terms, double all_pixels);

  NormalEquations geometric;
  PhotometricSystem photometric;
  Matrix6d displacement = Matrix6d::Zero();  // of the geometric pairs
  // Mean squared sine between the normals, for the geometric pairs, weighted, and for all pairs
  // near each other. Pairs that pass the gate of angles are similar by selection, whatever their
  // noise; those that do not may be edges or blur.
  double disagreement = 0, near_disagreement = 0;
  double geometric_base = 0;  // sum of the pairs' weights before robust weighting
  double geometric_error_m2 = 0, geometric_count = 0, photometric_count = 0, surface_count = 0,
         pixel_count = 0;
  // Mean squares of the residuals by Student's t distribution, in squared scales; 0 without pairs.
  double geometric_spread2 = 0, photometric_spread2 = 0;
  double photometric_squares = 0;  // sum of the weighted squared residuals
  // Share of the squared gradients of the frame's image that the map shows as well; the rest is
  // noise, blur and misalignment.
  double gradient_share = 0;

  // Return the mean weight of a pair whose residual is one standard deviation, times that residual
  // squared.
  double geometric_unit() const {
    return geometric_count > 0
               ? geometric_base / geometric_count * geometric_error_m2 / geometric_count
               : 0;
  }
  double photometric_unit() const {
    return photometric_count > 0 ? photometric_squares / photometric_count : 0;
  }
};

}  // namespace hermite::track
