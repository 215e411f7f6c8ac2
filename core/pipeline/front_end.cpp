#include "core/pipeline/front_end.h"

#include <algorithm>
#include <array>
#include <cmath>

#include "core/math/rigid3_fields.h"
#include "core/track/corner_regions.h"
#include "core/track/pose_guesses.h"

namespace hermite::pipeline {
namespace {

// The map of an object starts once this many corners move together, which is enough to determine a
// motion.
constexpr std::size_t kLeastObjectCorners = 20;

// Half a percent of the view can rotate the result if the rest constrains it poorly.
bool needs_realignment(const frame::CoarseMask& expected, const frame::CoarseMask& moving) {
  std::size_t unexpected = 0;
  for (std::size_t i = 0; i < moving.size(); ++i)
    unexpected += moving[i] != 0 && expected[i] == 0 ? 1 : 0;
  return 200 * unexpected > moving.size();
}

// Returns whether the pixel is near a moving corner.
bool is_near_what_moves(const std::vector<track::SeenCorner>& corners,
                        const Eigen::Vector2d& pixel) {
  constexpr double kSurroundings_px = 16;
  return std::any_of(corners.begin(), corners.end(), [&pixel](const track::SeenCorner& corner) {
    return corner.moves && (corner.pixel - pixel).cwiseAbs().maxCoeff() < kSurroundings_px;
  });
}

// Returns the rotation since the last frame, from the followed corners, or by aligning the images
// if they are too few.
Eigen::Quaterniond turn_since_last(const std::optional<track::FeatureMotion>& followed,
                                   const track::TrackOptions& options, track::Odometry& odometry,
                                   const frame::FrameMaps& maps) {
  if (followed) return followed->earlier_from_frame.rotation;
  return options.rotation_prealignment ? odometry.align_rotation(maps).conjugate()
                                       : Eigen::Quaterniond::Identity();
}

}  // namespace

FrontEnd::FrontEnd(const std::string& device_choice, const Camera& camera, const Options& options,
                   Timeline* timeline)
    : device(device_choice, timeline),
      commands(device),
      corners(rectified(camera), options.frame, options.track.object),
      options_(options),
      camera_(camera),
      preprocessor_(device, camera, options.frame),
      odometry_(device, preprocessor_.maps().camera(), options.track, options.frame),
      new_light_(options.frame.sampling * options.frame.sampling),
      visible_(device, options.map),
      index_(device, preprocessor_.maps().camera()),
      fuser_(device, preprocessor_.maps().camera(), options.map, options.frame),
      predictor_(device, preprocessor_.maps().camera(), options.map),
      store(device, most_slots(device, options.map.gpu_memory_mb, fuser_.new_slots_bound())),
      memory_(store, fuser_.new_slots_bound()) {}

void FrontEnd::preprocess(const frame::RgbdFrame& frame, std::int64_t frame_index) {
  preprocessor_.set_filter(frame::filter_widths(options_.frame, noise_));
  preprocessor_.run(commands, frame, frame_index);
}

track::Judgement FrontEnd::judge_start(const frame::FrameContent& content) {
  track::TrackingEvidence evidence;
  evidence.content = content;
  evidence.agreement = odometry_.agreement(preprocessor_.maps(), predictor_.surface(), Rigid3{});
  return track::judge_start(evidence, options_.track);
}

void FrontEnd::remember_view(const Rigid3& world_from_camera, const Rigid3& reference_from_camera,
                             const frame::PreparedFrame& frame) {
  remember_corners(frame.features, frame.frame.depth);
  corners.remember_points(frame.features, frame.frame.depth, reference_from_camera,
                          [&](const Eigen::Vector2d& pixel) {
                            return is_in_mask(moving_mask_, frame.features.image_px * pixel);
                          });
  if (!options_.track.object) {
    moving_.remember(view_, world_from_camera, moving_mask_);
    light_.remember(view_, world_from_camera, moving_mask_, light_mask_);
  }
  const frame::CoarseView measured = shading_.as_measured(view_);
  const auto comparison = earlier_.compare(measured, world_from_camera, moving_mask_);
  if (comparison && shading_.learn(measured, *comparison)) use_shading();
  earlier_.keep(measured, world_from_camera, moving_mask_,
                comparison ? comparison->places.size() : 0);
}

void FrontEnd::remember_corners(const frame::ImageFeatures& features, const DepthImage& depth) {
  const auto moves = [this](int x, int y) {
    return is_in_mask(moving_mask_, {x, y}) != options_.track.object;
  };
  const auto depth_m = [&](int x, int y) {
    return frame::depth_around(depth, x, y, camera_.depth_units_per_metre, options_.frame);
  };
  corners.remember_tracks(features, depth_m, moves);
}

void FrontEnd::forget_views() {
  if (!options_.track.object) moving_.forget();
  earlier_.forget();
  light_.forget();
}

map::ColorFusion fusion_of_colors(const track::Judgement& judgement) {
  if (judgement.light_has_changed) return map::ColorFusion::kReplace;
  return judgement.image_is_good ? map::ColorFusion::kMean : map::ColorFusion::kKeep;
}

track::MapCertainty::Ground ground_of(const adjust::MapLayout& layout) {
  return {layout.world_from_submap, layout.is_active, layout.current, layout.closure_count};
}

track::PoseUncertainty FrontEnd::uncertainty_at(const Rigid3& world_from_camera,
                                                const track::OdometryResult& step,
                                                track::MapCertainty::StepError error,
                                                const adjust::MapLayout& layout) {
  error.covariance = track::found_again(world_from_camera);
  if (step.witnesses.depth.unit > 0) {
    const Matrix6d change = adjoint(world_from_camera * inverse(step.reference_from_camera));
    error.covariance = change * track::step_covariance(step.witnesses) * change.transpose();
  }
  error.disagreement = moving_.disagreement();
  const track::PoseUncertainty observed =
      certainty_.observe(view_, moving_mask_, world_from_camera, error, ground_of(layout));
  return track::with_error(track::with_steps(observed, steps_.mean()), moving_.pull_world(),
                           world_from_camera.translation);
}

// Applies the learned lens shading to the following frames.
void FrontEnd::use_shading() {
  preprocessor_.set_shading(shading_.of_pixels(frame::intrinsics_of(camera_)));
}

// Masks pixels of the last preprocessed frame, and the brightness of others.
void FrontEnd::hide(const frame::CoarseMask& mask, const frame::CoarseMask& light) {
  if (!track::has_any(mask) && !track::has_any(light)) return;
  if (track::has_any(mask)) preprocessor_.mask(commands, mask);
  if (track::has_any(light)) preprocessor_.mask_image(commands, light);
  commands.submit_and_wait();
}

// Returns the mask of everything but the object. Its motion is detected in the frame of the room,
// in which resting corners are followed.
frame::CoarseMask FrontEnd::background_of_object(const track::CornerVerdict& seen) {
  frame::CoarseMask object =
      track::regions_of_corners(view_, surfaces_, seen.corners, camera_.width);
  if (seen.last_from_frame) room_from_camera_ = room_from_camera_ * *seen.last_from_frame;
  if (seen.last_from_frame && seen.moves_now)
    object = moving_.contradicted(view_, surfaces_, room_from_camera_, object);
  if (!seen.last_from_frame) moving_.forget();
  moving_.remember(view_, room_from_camera_, object);
  for (shared::uint& pixel : object) pixel = 1 - pixel;
  return object;
}

// Returns the mask of the last preprocessed frame before its pose is known.
frame::CoarseMask FrontEnd::hidden_by_corners(const track::CornerVerdict& seen) {
  return options_.track.object
             ? background_of_object(seen)
             : track::regions_of_corners(view_, surfaces_, seen.corners, camera_.width);
}

// Aligns the frame with the prediction and masks its moving regions. The brightness of pixels
// counts only where the light is as it was.
track::OdometryResult FrontEnd::align(const std::vector<Rigid3>& starts,
                                      const track::FeatureMotion* held,
                                      const frame::CoarseMask& hidden,
                                      const Rigid3& world_from_reference, int lost_count) {
  frame::CoarseMask expected = options_.track.object ? hidden : moving_.expected(view_);
  for (std::size_t i = 0; i < expected.size(); ++i) expected[i] |= hidden[i];
  const frame::CoarseMask expected_light = light_mask_;
  hide(expected, expected_light);
  const frame::FrameMaps& maps = preprocessor_.maps();
  const frame::SurfacePyramid& reference = predictor_.surface();
  track::OdometryResult found;
  if (lost_count == 0) found = odometry_.track(maps, reference, starts, held);
  const auto is_found = [&] {
    return track::is_believable(found.agreement, found.reference_from_camera, options_.track);
  };
  if (!is_found()) found = odometry_.search(maps, reference, track::with_turns(starts));
  const auto contradict = [&] {
    const Rigid3 world_from_camera = world_from_reference * found.reference_from_camera;
    moving_mask_ = moving_.contradicted(view_, surfaces_, world_from_camera, hidden);
    light_mask_ = light_.changed(view_, world_from_camera, moving_mask_);
  };
  if (options_.track.object) {
    moving_mask_ = hidden;
  } else if (is_found()) {  // if the frame shows another place, the remainder must not be trusted
    // Moving regions follow from the pose, and the pose from the static rest: align once more if
    // many unexpected pixels move.
    contradict();
    if (needs_realignment(expected, moving_mask_) ||
        needs_realignment(expected_light, light_mask_)) {
      hide(moving_mask_, light_mask_);
      const bool is_ambiguous = found.is_ambiguous;
      found = odometry_.track(maps, reference, std::array{found.reference_from_camera}, held);
      found.is_ambiguous = is_ambiguous;
      contradict();
    }
  }
  hide(moving_mask_, {});
  return found;
}

Motion FrontEnd::track(const frame::PreparedFrame& frame, const track::CornerVerdict& seen,
                       const Rigid3& world_from_reference, const Rigid3& last_motion,
                       int lost_count) {
  const frame::ImageFeatures& features = frame.features;
  const bool of_object = options_.track.object;
  view_ = frame::coarse_view(preprocessor_.maps().surface);
  moving_mask_.assign(view_.size(), of_object ? 1 : 0);
  light_mask_ = light_.expected(view_);
  if (frame_number == 0 && !of_object) return {{}, judge_start(frame.content)};
  if (of_object && frame_number == 0 && seen.moving.size() < kLeastObjectCorners) {
    hide(moving_mask_, {});
    remember_corners(features, frame.frame.depth);
    return {{},
            {track::TrackingStatus::kLost, "waiting: no object moves in front of the camera yet"}};
  }
  surfaces_ = track::surfaces_of(view_);
  const frame::CoarseMask hidden = hidden_by_corners(seen);
  if (frame_number == 0) {
    moving_mask_ = hidden;
    hide(hidden, {});
    return {{}, judge_start(frame.content)};
  }
  const double step = features.image_px;
  const std::optional<track::FeatureMotion> followed =
      corners.follow_points(features, [&](const Eigen::Vector2d& pixel) {
        return is_in_mask(hidden, step * pixel) || is_in_mask(light_mask_, step * pixel) ||
               (!of_object && is_near_what_moves(seen.corners, step * pixel));
      });
  const track::FeatureMotion* held = followed && !followed->is_turn_only ? &*followed : nullptr;
  const Rigid3 turned{turn_since_last(followed, options_.track, odometry_, preprocessor_.maps()),
                      Eigen::Vector3d::Zero()};
  track::OdometryResult found =
      align(track::pose_guesses(turned, last_motion, held, options_.track), held, hidden,
            world_from_reference, lost_count);
  const Rigid3& motion = found.reference_from_camera;
  const bool is_found = track::is_believable(found.agreement, motion, options_.track);
  track::TrackingEvidence evidence;
  evidence.content = frame.content;
  if (held) evidence.corners = track::corners_at(*held, motion);
  evidence.is_divided = is_found && !of_object &&
                        (moving_.is_divided() || seen.is_divided ||
                         track::do_contradict(seen.resting, rectified(camera_), motion));
  evidence.lost_count = lost_count;
  evidence.is_ambiguous = found.is_ambiguous;
  evidence.usual_information = usual_information_;
  new_light_.describe(evidence);
  if (!is_found)
    evidence.unmoved = odometry_.agreement(preprocessor_.maps(), predictor_.surface(), turned);
  evidence.agreement = found.agreement;
  evidence.inlier_share = (of_object ? 1 : found.agreement.surface) * found.inlier_ratio;
  evidence.observability = found.observability;
  evidence.reference_from_camera = motion;
  evidence.turn_seen_rad = angle_rad(turned.rotation);
  track::Judgement judgement = track::judge(evidence, options_.track);
  follow_image(judgement, found);
  return {found, std::move(judgement)};
}

// Learns from the frame what the images of the next ones are compared with.
void FrontEnd::follow_image(const track::Judgement& judgement, track::OdometryResult& found) {
  if (judgement.status != track::TrackingStatus::kLost)
    usual_information_ = track::usual_information_after(usual_information_, found.agreement);
  if (!new_light_.follow(judgement, found.brightness)) return;
  // Views in the old light would take the new one for a spot of light, or for shading of the lens.
  light_.forget();
  earlier_.forget();
}

void FrontEnd::keep(const frame::PreparedFrame& frame, const adjust::MapLayout& layout) {
  corners.remember_start(frame.features, frame.frame.depth);
  store.set_submaps(layout.world_from_submap);
  predict_from(Rigid3{}, layout.is_active, map::FillIn::kSurfaceAndColor);
}

std::optional<Rigid3> FrontEnd::motion_since_kept(const Rigid3& guess) {
  const track::OdometryResult found =
      odometry_.track(preprocessor_.maps(), predictor_.surface(), std::array{guess});
  if (!track::is_believable(found.agreement, found.reference_from_camera, options_.track))
    return std::nullopt;
  return found.reference_from_camera;
}

// Records the prediction of these submaps alone, and of the last preprocessed frame where that is
// to fill the rest in.
void FrontEnd::predict_from(const Rigid3& world_from_camera, const map::SubmapSet& submaps,
                            map::FillIn fill_in) {
  const frame::FrameMaps& maps = preprocessor_.maps();
  store.set_camera(world_from_camera, submaps);
  visible_.list(commands, store, maps.camera(), frame_number);
  index_.build(commands, store, maps.camera(), options_.map.stable_confidence);
  predictor_.run(commands, store, index_, maps, fill_in);
  frame::downsample(commands, preprocessor_.downsample_kernel(), predictor_.surface(),
                    0.5 * options_.frame.depth_gate_m);
}

std::optional<adjust::LoopVerification> FrontEnd::verify(const adjust::LoopCandidate& candidate,
                                                         const adjust::MapLayout& layout) {
  store.set_submaps(layout.world_from_submap);
  map::SubmapSet submaps = candidate.submaps;
  submaps.resize(layout.world_from_submap.size(), false);
  // No memory for the candidate besides the active submaps.
  if (!memory_.hold(submaps, layout)) return std::nullopt;
  predict_from(candidate.world_from_camera, submaps);
  commands.submit_and_wait();
  const std::vector<Rigid3> start{Rigid3{}};
  const track::OdometryResult found =
      odometry_.search(preprocessor_.maps(), predictor_.surface(), start);
  if (!track::is_same_place(found.agreement, found.observability, usual_information_))
    return std::nullopt;
  return adjust::LoopVerification{candidate.world_from_camera * found.reference_from_camera,
                                  found.agreement.overlap};
}

bool FrontEnd::fuse(const Rigid3& world_from_camera, const adjust::MapLayout& layout,
                    const ColorUse& color) {
  const frame::FrameMaps& maps = preprocessor_.maps();
  ++frame_number;
  const bool add_new = memory_.make_room(layout, frame_number);
  store.set_submaps(layout.world_from_submap);
  store.set_camera(world_from_camera, layout.is_active);
  visible_.list(commands, store, maps.camera(), frame_number);
  index_.build(commands, store, maps.camera(), 0);
  index_.describe(commands, store, maps.camera());
  fuser_.fuse(commands, maps, store, index_,
              {frame_number, color.fusion, memory_.submap(), add_new, color.brightness});
  return add_new;
}

void FrontEnd::clean_and_predict(const ColorUse& color) {
  const frame::FrameMaps& maps = preprocessor_.maps();
  visible_.list(commands, store, maps.camera(), frame_number);
  index_.build(commands, store, maps.camera(), options_.map.stable_confidence);
  fuser_.clean(commands, maps, store, index_, {frame_number, color.fusion, memory_.submap()});
  predictor_.run(commands, store, index_, maps,
                 color.is_good() ? map::FillIn::kSurfaceAndColor : map::FillIn::kSurface,
                 color.brightness);
  frame::downsample(commands, preprocessor_.downsample_kernel(), predictor_.surface(),
                    0.5 * options_.frame.depth_gate_m);
  odometry_.remember(commands, maps);
}

void FrontEnd::predict(const Rigid3& world_from_camera, const adjust::MapLayout& layout) {
  store.set_submaps(layout.world_from_submap);
  memory_.hold(layout.is_active, layout);  // submaps that do not fit are not predicted
  predict_from(world_from_camera, layout.is_active);
}

void FrontEnd::save(ByteWriter& bytes) const {
  bytes.number(frame_number);
  noise_.save(bytes);
  steps_.save(bytes);
  corners.save(bytes);
  bytes.number(usual_information_);
  new_light_.save(bytes);
  rigid3_fields(bytes, room_from_camera_);
  frame::save(bytes, predictor_.surface());
  odometry_.save(bytes);
  moving_.save(bytes);
  light_.save(bytes);
  earlier_.save(bytes);
  shading_.save(bytes);
  certainty_.save(bytes);
  store.save(bytes);
  memory_.save(bytes);
}

void FrontEnd::restore(ByteReader& bytes) {
  bytes.number(frame_number);
  noise_.restore(bytes);
  steps_.restore(bytes);
  corners.restore(bytes);
  bytes.number(usual_information_);
  bytes.require(std::isfinite(usual_information_) && usual_information_ >= 0,
                "the usual information of images is not a positive number");
  new_light_.restore(bytes);
  rigid3_fields(bytes, room_from_camera_);
  frame::restore(bytes, predictor_.surface());
  odometry_.restore(bytes);
  moving_.restore(bytes);
  light_.restore(bytes);
  earlier_.restore(bytes);
  shading_.restore(bytes);
  certainty_.restore(bytes);
  use_shading();
  store.restore(bytes);
  memory_.restore(bytes);
}

}  // namespace hermite::pipeline
