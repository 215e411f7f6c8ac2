// Is a pose to be believed? And if not, why: in words for the person who holds the camera. Pure functions of values.
#pragma once

#include <string>

#include "core/frame/frame_content.h"
#include "core/math/rigid3.h"
#include "core/track/feature_motion.h"
#include "core/track/map_certainty.h"
#include "core/track/step_certainty.h"
#include "core/track/track_options.h"

namespace hermite {

// Weak: the pose is believed and the frame is fused, but little is missing to lose the camera, or the map is full: a warning. Lost: nothing
// of the frame is used.
enum class TrackingStatus { kTracked, kWeak, kLost };
const char* name_of(TrackingStatus status);  // "tracked", "weak", "lost"

// The frame's surface beside the predicted one, at the pose found. Shares, 0 to 1.
struct Agreement {
  double surface = 0;   // of the frame's pixels: have a surface
  double overlap = 0;   // of these: fall onto the prediction
  double agreeing = 0;  // of these: lie on it, within thrice the sensor's noise and what a model may be off by
  double in_front = 0;  // of those that overlap: clearly nearer than the prediction
  // Normalised cross correlation of the grey values of those that agree, -1 to 1, and their standard deviations.
  double correlation = 0;
  double grey_deviation = 0, reference_grey_deviation = 0;
  double sharpness = 0;  // changes of grey between neighbours, of those in the prediction: falls when the picture is dark or blurred
};

// All that is known about one frame's motion.
struct TrackingEvidence {
  FrameContent content;
  Agreement agreement;
  Agreement unmoved;  // the same where the camera was before, turned as the pictures say; only needed of a pose that is not believable
  double inlier_share = 0;       // geometric correspondences, of all pixels
  double observability = 0;      // see core/track/normal_equations.h
  CornerAgreement corners;       // that were followed from the frame before, at this motion
  bool is_divided = false;       // large parts of the view move against each other, see core/track/own_motion.h
  Rigid3 reference_from_camera;  // the motion found
  double turn_seen_rad = 0;      // of the pictures alone, before tracking
  int lost_count = 0;            // frames lost just before this one
};

struct Judgement {
  TrackingStatus status = TrackingStatus::kLost;
  std::string reason;           // empty when tracked
  bool picture_is_good = true;  // the colours may be believed
};

// Whether frame and map have an image to compare, with contrast in both.
bool has_picture(const Agreement& agreement);

// Whether the frame shows what the map says where this motion has brought the camera. If not, another start may find a better one.
bool is_believable(const Agreement& agreement, const Rigid3& reference_from_camera, const TrackOptions& options);

// Whether a camera that may be anywhere is here: a stricter question, since the map is bent to the answer.
bool is_same_place(const Agreement& agreement, double observability);

// Of a frame that was tracked against the map.
Judgement judge(const TrackingEvidence& evidence, const TrackOptions& options);

// What is known of the pose beside what the frame shows.
struct Doubts {
  PoseUncertainty uncertainty;
  CalibrationDoubt calibration;
  Contradiction contradiction;  // of the witnesses of the step
};

// The judgement of a frame that is believed, in view of that: what is called tracked is known to 4 cm and a percent of the way.
Judgement weighed(Judgement judgement, const Doubts& doubts);

// Of a frame that could begin a map: whether it shows enough surface.
Judgement judge_start(const TrackingEvidence& evidence, const TrackOptions& options);

}  // namespace hermite
