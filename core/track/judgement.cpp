#include "core/track/judgement.h"

#include <fmt/core.h>

#include <algorithm>
#include <cmath>

namespace hermite::track {

namespace {

// In well tracked frames of every recording and kind of noise that was tried, at least 91 % of the
// overlap agreed, with a correlation of at least 0.82; in frames of other places, at most 55 %
// agreed or the correlation was below 0.55 (tests/accuracy/LAB.md).
constexpr double kGoodAgreement = 0.85, kGoodCorrelation = 0.6, kGoodOverlap = 0.4;

// Moving regions are excluded from the comparison. If nevertheless three quarters or less agree,
// the correlation must be nearly conclusive: frames of the same walls with other furniture were
// once aligned with 77 % agreeing and a correlation of 0.73, and with 68 % and 0.84.
constexpr double kDoubtfulAgreement = 0.75, kSameCorrelation = 0.88;

// A place can be recognised from a quarter of a view if the overlap fits as well as this.
constexpr double kLeastOldGround = 0.25, kSureAgreement = 0.95, kSureCorrelation = 0.9;

// Standard deviation of grey values below which there is no image to compare.
constexpr double kFlatImage = 5;

// Texture of a white or black image, or of one with the lens covered; an ordinary room has 1.7 and
// more.
constexpr double kNoTexture = 0.5, kDark = 12;

// Least sharpness; good frames of all recordings have 0.88 to 1.5.
constexpr double kBlurred = 0.6;

// Least observability at a place to which the map is to be deformed.
constexpr double kBlankPlace = 2e-4;

// Least share of the usual information of the image, at a place where the camera may be from
// anywhere. Revisits of a recorded kitchen had 58 to 95 % where at least 5 % of the view
// overlapped; between bare walls a true place had all of it, and false ones, where all of the
// overlap agreed in depth, 25 to 38 %.
constexpr double kRecognisedInformation = 0.5;

// Least share of inliers; rooms give 0.2 and more.
constexpr double kFewInliers = 0.1;

// Fewer points suffice if followed corners, as independent evidence, confirm the motion: at least
// this many, and this share of them.
constexpr int kHoldingCorners = 20;
constexpr double kHoldingShare = 0.7;

// Share of the pixels; if a frame with less surface is lost, that is the reason.
constexpr double kLittleSurface = 0.03;

// A Kinect v1 measures from half a metre.
constexpr double kTooNear_m = 0.6;

// A fifth of the field of view of most cameras.
constexpr double kFastTurn_rad = 10 * M_PI / 180;

// Above this standard deviation and this share of the path length, the frame is called weak. Where
// the camera is wrong in a way that is not known yet (depth bent by 1.5 %, a focal length 1 % off),
// most frames exceed it before they are 5 cm off. Undisturbed scans stay below, except between bare
// walls before the camera was found to fit (tests/accuracy/README.md, "What is stated").
constexpr double kMostUncertain_m = 0.03, kMostDrift = 0.01;

// Terraces of depth (core/frame/depth_steps.h) that lead a camera: 4 mm at 3 m, from disparity in
// sixths of a pixel, change no error; 22 mm, from quarters, hold it for the first frames, by up to
// 15 cm. Recordings of Kinects have below 1 mm.
constexpr double kMostTerrace_m = 0.01;

// The motions that depth, image and corners each give alone differ by up to 15 mm, 0.8 degrees and
// 25 standard deviations on recordings of a Kinect, and by up to 30 mm if depth is bent.
constexpr double kContradictingSigmas = 8, kContradicting_m = 0.025,
                 kContradicting_rad = 1.5 * M_PI / 180;

std::string percent(double share) { return std::to_string(std::lround(100 * share)) + " %"; }
std::string centimetres(double distance_m) {
  return std::to_string(std::lround(100 * distance_m)) + " cm";
}
std::string degrees(double angle_rad) {
  return std::to_string(std::lround(angle_rad * 180 / M_PI)) + " degrees";
}

double step_m(const Rigid3& motion) { return motion.translation.norm(); }
double turn_rad(const Rigid3& motion) { return angle_rad(motion.rotation); }

bool is_fast(const Rigid3& motion, const TrackOptions& options) {
  return step_m(motion) > 0.5 * options.max_step_m || turn_rad(motion) > kFastTurn_rad;
}

bool shows_nothing(const frame::FrameContent& content) {
  return content.mean_grey < kDark || content.texture < kNoTexture;
}

std::string too_few_points(const frame::FrameContent& content) {
  if (content.too_near > 0.2 || (content.in_range > 0.002 && content.median_m < kTooNear_m))
    return "too near: step back, the depth camera cannot see what is right in front of it";
  return "too few points: the depth camera sees almost nothing";
}

std::string why_lost(const TrackingEvidence& e, const TrackOptions& options) {
  if (e.agreement.surface < kLittleSurface) return too_few_points(e.content);
  const bool first = e.lost_count == 0;
  if (e.unmoved.overlap >= options.min_overlap && e.unmoved.in_front > 0.4)
    return "occluded: something is in front of what was scanned";
  if (shows_nothing(e.content)) return "dark or blurred: the picture shows nothing";
  const double turned_rad = std::max(e.turn_seen_rad, turn_rad(e.reference_from_camera));
  if (first && turned_rad > kFastTurn_rad)
    return fmt::format("too fast: the camera turned by {} between two frames", degrees(turned_rad));
  if (e.observability < kNoiseObservability) return "blank surface: nothing to hold on to";
  return "too little in common with the scan so far";
}

bool is_recognised(const Agreement& agreement, double usual_information) {
  return image_information(agreement) >= kRecognisedInformation * usual_information;
}

// A lost camera that seems to be far from where it was lost may be anywhere.
bool is_found_far_away(const TrackingEvidence& e, const TrackOptions& options) {
  return e.lost_count > 0 && is_fast(e.reference_from_camera, options);
}

std::string why_not_recognised(const TrackingEvidence& e) {
  if (!has_image(e.agreement))
    return e.observability < kBlankPlace ? "blank surface: nothing to hold on to" : "";
  return is_recognised(e.agreement, e.usual_information)
             ? ""
             : "too little in common with the scan so far";
}

bool is_held_by_corners(const CornerAgreement& corners) {
  return corners.count >= kHoldingCorners && corners.share >= kHoldingShare;
}

std::string why_weak(const TrackingEvidence& e, const TrackOptions& options) {
  const Agreement& a = e.agreement;
  if (e.inlier_share < kFewInliers && !is_held_by_corners(e.corners))
    return fmt::format("too few points: only {} of the image can be used", percent(e.inlier_share));
  if (e.is_divided)
    return "moving: large parts of the view go different ways, and which is the room cannot be "
           "told";
  if (a.overlap < kGoodOverlap)
    return fmt::format("too little in common: only {} of the view has been scanned",
                       percent(a.overlap));
  if (a.agreeing < kGoodAgreement && a.in_front > 0.5 * (1 - a.agreeing))
    return "occluded: something is in front of what was scanned";
  if (a.agreeing < kGoodAgreement)
    return fmt::format("too little in common: {} of what was scanned is not where it was",
                       percent(1 - a.agreeing));
  const double moved_m = step_m(e.reference_from_camera),
               turned_rad = turn_rad(e.reference_from_camera);
  if (moved_m > 0.5 * options.max_step_m)
    return fmt::format("too fast: {} between two frames", centimetres(moved_m));
  if (turned_rad > kFastTurn_rad)
    return fmt::format("too fast: the camera turned by {} between two frames", degrees(turned_rad));
  if (e.observability < kNoiseObservability) return "blank surface: little to hold on to";
  return "";
}

bool is_like_the_model(const Agreement& a) {
  if (a.reference_grey_deviation < kFlatImage) return true;  // nothing to compare with
  return a.grey_deviation >= kFlatImage && a.sharpness >= kBlurred &&
         a.correlation >= kGoodCorrelation;
}

// When a lamp goes out, what the image shows has other grey values all over, but it is sharp, the
// shape is the same, and corners go on as the camera does. If the camera was lost meanwhile,
// another place may look so.
bool is_in_new_light(const TrackingEvidence& e) {
  const Agreement& a = e.agreement;
  const bool differs =
      e.is_light_new || (a.correlation < kGoodCorrelation && a.sharpness >= kBlurred);
  return e.follows_good_image && differs && a.grey_deviation >= kFlatImage &&
         a.agreeing >= kGoodAgreement && is_held_by_corners(e.corners);
}

}  // namespace

const char* name_of(TrackingStatus status) {
  switch (status) {
    case TrackingStatus::kTracked: return "tracked";
    case TrackingStatus::kWeak: return "weak";
    case TrackingStatus::kLost: break;
  }
  return "lost";
}

bool has_image(const Agreement& a) {
  return a.grey_deviation > kFlatImage && a.reference_grey_deviation > kFlatImage;
}

double image_information(const Agreement& a) {
  constexpr double kHighestCorrelation = 0.999;  // a rendered room; and the logarithm stays finite
  if (!has_image(a)) return 0;
  const double correlation = std::clamp(a.correlation, 0.0, kHighestCorrelation);
  return -0.5 * std::log(1 - correlation * correlation);
}

double usual_information_after(double usual, const Agreement& agreement) {
  constexpr double kNew = 1.0 / 32;
  const double information = image_information(agreement);
  return usual == 0 ? information : usual + kNew * (information - usual);
}

// Geometry alone suffices if nearly all of it agrees; if something has moved, the image of the rest
// must match better. After a large motion much may fit by chance: a frame out of order was once
// accepted 13 cm off, where 76 % agreed with a correlation of 0.58.
bool is_believable(const Agreement& a, const Rigid3& reference_from_camera,
                   const TrackOptions& options) {
  if (a.overlap < options.min_overlap || a.agreeing < options.min_agreement) return false;
  if (!has_image(a)) return a.agreeing >= kGoodAgreement;
  if (is_fast(reference_from_camera, options))
    return a.agreeing >= kGoodAgreement && a.correlation >= kGoodCorrelation;
  const double missing =
      std::clamp((kGoodAgreement - a.agreeing) / (kGoodAgreement - kDoubtfulAgreement), 0.0, 1.0);
  return a.correlation >=
         options.min_correlation + (kSameCorrelation - options.min_correlation) * missing;
}

// Where old and new ground meet, only a part of the view is old; the smaller that part, the better
// it must fit. Of 45 revisits in a walk around two rooms that were rejected only for their overlap
// (0.25 to 0.39), all but one agreed in at least 96 % with a correlation of at least 0.97.
bool is_same_place(const Agreement& a, double observability, double usual_information) {
  if (a.overlap < kLeastOldGround || observability < kBlankPlace) return false;
  const double missing = std::max(0.0, kGoodOverlap - a.overlap) / (kGoodOverlap - kLeastOldGround);
  const auto needed = [missing](double usual, double strict) {
    return usual + (strict - usual) * missing;
  };
  const bool looks_alike = has_image(a)
                               ? a.correlation >= needed(kGoodCorrelation, kSureCorrelation) &&
                                     is_recognised(a, usual_information)
                               : missing == 0;
  return a.agreeing >= needed(kGoodAgreement, kSureAgreement) && looks_alike;
}

Judgement judge(const TrackingEvidence& e, const TrackOptions& options) {
  if (e.agreement.surface < options.min_surface_ratio)
    return {TrackingStatus::kLost, too_few_points(e.content)};
  if (!is_believable(e.agreement, e.reference_from_camera, options))
    return {TrackingStatus::kLost, why_lost(e, options)};
  if (e.is_ambiguous)
    return {TrackingStatus::kLost, "ambiguous: what the camera sees fits more than one place"};
  if (is_found_far_away(e, options))
    if (const std::string reason = why_not_recognised(e); !reason.empty())
      return {TrackingStatus::kLost, reason};
  // The longer the camera was lost, the farther it may have moved.
  const double jumped_m = step_m(e.reference_from_camera);
  if (jumped_m > options.max_step_m * (1 + e.lost_count))
    return {TrackingStatus::kLost,
            "too fast: the camera would have jumped " + centimetres(jumped_m)};
  Judgement judgement{TrackingStatus::kTracked, why_weak(e, options),
                      is_like_the_model(e.agreement) && !shows_nothing(e.content)};
  judgement.light_has_changed = (!judgement.image_is_good || e.is_light_new) && is_in_new_light(e);
  if (judgement.reason.empty() && judgement.light_has_changed)
    judgement.reason = "light: it has changed, and the picture is not like those before";
  if (judgement.reason.empty() && !is_like_the_model(e.agreement))
    judgement.reason = "dark or blurred: the picture is not like those before";
  if (!judgement.reason.empty()) judgement.status = TrackingStatus::kWeak;
  return judgement;
}

Judgement weighed(Judgement judgement, const Doubts& doubts) {
  if (judgement.status != TrackingStatus::kTracked) return judgement;
  const Contradiction& apart = doubts.contradiction;
  const double sigma_m = doubts.uncertainty.position_sigma_m();
  if (apart.sigmas > kContradictingSigmas &&
      (apart.distance_m > kContradicting_m || apart.turn_rad > kContradicting_rad))
    judgement.reason = fmt::format("{} and {} disagree: by {} and {}", apart.first, apart.second,
                                   centimetres(apart.distance_m), degrees(apart.turn_rad));
  if (doubts.uncertainty.elsewhere_m > 0)
    judgement.reason =
        "unconfirmed: this may be a place that looks the same; show more of what was seen before";
  if (doubts.uncertainty.steps.terrace_m > kMostTerrace_m)
    judgement.reason = fmt::format(
        "depth is measured in steps of {}, which its noise does not average out: the camera may "
        "follow the steps",
        centimetres(doubts.uncertainty.steps.step_m));
  if (!doubts.calibration.reason().empty()) judgement.reason = doubts.calibration.reason();
  if (judgement.reason.empty() &&
      sigma_m > kMostUncertain_m + kMostDrift * doubts.uncertainty.way_m)
    judgement.reason = fmt::format("uncertain: the camera may be {} from where it seems to be",
                                   centimetres(2 * sigma_m));
  if (!judgement.reason.empty()) judgement.status = TrackingStatus::kWeak;
  return judgement;
}

Judgement judge_start(const TrackingEvidence& e, const TrackOptions& options) {
  if (e.agreement.surface < options.min_surface_ratio)
    return {TrackingStatus::kLost, too_few_points(e.content)};
  return {TrackingStatus::kTracked, ""};
}

}  // namespace hermite::track
