// Decides whether a pose is credible, and if not gives the reason as text for the person who holds
// the camera. Pure functions of values.
#pragma once

#include <string>

#include "core/frame/frame_content.h"
#include "core/math/rigid3.h"
#include "core/track/calibration_doubt.h"
#include "core/track/feature_motion.h"
#include "core/track/pose_uncertainty.h"
#include "core/track/step_certainty.h"
#include "core/track/track_options.h"

namespace hermite::track {

// Weak: the pose is credible, with a warning (the reason). The frame is fused, unless its depth
// repeats the last one's or it is the first of a camera with a rolling shutter
// (core/pipeline/reconstruction.cpp). Lost: nothing of the frame is used.
enum class TrackingStatus { kTracked, kWeak, kLost };
const char* name_of(TrackingStatus status);  // "tracked", "weak", "lost"

// Agreement of the frame's surface with the predicted one at the estimated pose. Shares, 0 to 1.
struct Agreement {
  double surface = 0;  // share of the frame's pixels that have a surface
  double overlap = 0;  // share of these that project onto the prediction
  // Share of these that lie on it, within three times the sensor's noise plus a tolerance for the
  // model.
  double agreeing = 0;
  double in_front = 0;  // share of the overlap that is clearly nearer than the prediction
  // Normalised cross-correlation of the grey values of the agreeing pixels, -1 to 1, and their
  // standard deviations.
  double correlation = 0;
  double grey_deviation = 0, reference_grey_deviation = 0;
  // Grey differences between neighbours over those in the prediction; falls if the image is dark or
  // blurred.
  double sharpness = 0;
};

// All evidence about one frame's motion.
struct TrackingEvidence {
  frame::FrameContent content;
  Agreement agreement;
  // Agreement at the previous position, rotated as the images say; only needed if the pose is not
  // credible.
  Agreement unmoved;
  double inlier_share = 0;   // geometric correspondences over all pixels
  double observability = 0;  // see core/track/normal_equations.h
  CornerAgreement corners;   // of the corners followed from the frame before, at this motion
  // Large parts of the view move relative to each other, see core/track/own_motion.h.
  bool is_divided = false;
  Rigid3 reference_from_camera;  // the estimated motion
  double turn_seen_rad = 0;      // rotation from the images alone, before tracking
  int lost_count = 0;            // frames lost just before this one
  bool is_ambiguous = false;     // the frame fits nearly as well elsewhere
  double usual_information = 0;  // image_information() of the frames tracked so far
  // The camera was not lost since a frame whose image was like the map's.
  bool follows_good_image = false;
  // The light has just changed, and so far only some colours of the map are those of the new light.
  bool is_light_new = false;
};

struct Judgement {
  TrackingStatus status = TrackingStatus::kLost;
  std::string reason;         // empty when tracked
  bool image_is_good = true;  // the colours may be fused
  // The image differs from the map's because the light has changed: its colours replace those of
  // the map.
  bool light_has_changed = false;
};

// Returns whether frame and map both have an image with contrast, so that they can be compared.
bool has_image(const Agreement& agreement);

// Returns what the grey values of frame and map tell about each other, in nats per pixel of the
// overlap: the mutual information of normal distributions with that correlation. 0 without an
// image, or where the correlation is not positive.
double image_information(const Agreement& agreement);

// Returns the usual information after another tracked frame: the mean over about the last second.
// 0: of the first one.
double usual_information_after(double usual, const Agreement& agreement);

// Returns whether the frame shows what the map predicts at the estimated motion. If it does not,
// another starting point may lead to a better one.
bool is_believable(const Agreement& agreement, const Rigid3& reference_from_camera,
                   const TrackOptions& options);

// Returns whether a camera that may be anywhere is at this place. This is stricter, because the map
// is deformed to fit the answer. `usual_information`: of the scan's images.
bool is_same_place(const Agreement& agreement, double observability, double usual_information);

// Judges a frame that was tracked against the map.
Judgement judge(const TrackingEvidence& evidence, const TrackOptions& options);

// What is known about the pose in addition to the frame's agreement.
struct Doubts {
  PoseUncertainty uncertainty;
  CalibrationDoubt calibration;
  Contradiction contradiction;  // between the evidence from depth, image and corners
};

// Returns the judgement of an accepted frame in view of these doubts: a tracked pose is known to 3
// cm plus one percent of the path length (standard deviation).
Judgement weighed(Judgement judgement, const Doubts& doubts);

// Judges a frame that could start a map: whether it shows enough surface.
Judgement judge_start(const TrackingEvidence& evidence, const TrackOptions& options);

}  // namespace hermite::track
