// What one linearisation of the odometry says about the motion: how much depth, image and followed
// corners count, and what residuals to expect at the next pose. Pure functions of values. Any
// thread.
#pragma once

#include <optional>

#include "core/frame/brightness.h"
#include "core/math/rigid3.h"
#include "core/track/feature_motion.h"
#include "core/track/normal_equations.h"
#include "core/track/odometry_sums.h"
#include "core/track/step_certainty.h"

namespace hermite::track {

// The residuals to expect before a step.
struct ExpectedResiduals {
  double geometric_scale = 0;    // standard deviations of the sensor
  double photometric_scale = 0;  // grey values
  frame::Brightness brightness;
};

// Returns what to expect before the first step, when the pose may be off by centimetres, or
// `reach` times that, and the exposure by a fifth.
ExpectedResiduals residuals_at_first(double reach);

// Returns what to expect after a step. Scales follow the residuals, down to the model's error and
// the quantisation of grey values; closer agreement is chance.
ExpectedResiduals residuals_after(const ExpectedResiduals& before, const OdometrySums& sums,
                                  const Vector6d& step);

// Returns the weight of the image as evidence at the final pose: gradients of noise wrongly say
// with certainty that the camera stands still. During the alignment the image has full weight in
// all steps, because one that is not aligned yet may look like noise.
double share_of_image(const OdometrySums& sums);

// What constrains a step besides depth and, usually, the image.
struct StepTerms {
  bool discount_normal_noise = true;  // of depth
  bool is_finest = false;             // of the levels, where the frame is nearly aligned
  std::optional<Rigid3> prior;  // set: expected motion, which then constrains in place of the image
  const FeatureMotion* corners = nullptr;  // followed from the reference; may be null
};

// The systems to solve for the step, and what each kind of residuals says as evidence on its own.
struct StepSystems {
  NormalEquations geometric, photometric;
  StepWitnesses witnesses;
};
StepSystems step_systems(const OdometrySums& sums, const frame::Brightness& brightness,
                         const Rigid3& reference_from_camera, const StepTerms& terms);

}  // namespace hermite::track
