#include "core/pipeline/pipeline.h"

#include <chrono>
#include <optional>

#include "core/frame/frame_content.h"
#include "core/frame/preprocess.h"
#include "core/frame/undistort.h"
#include "core/gpu/device.h"
#include "core/map/fuse.h"
#include "core/map/index_map.h"
#include "core/map/predict.h"
#include "core/map/surfel_store.h"
#include "core/map/visible_blocks.h"
#include "core/track/odometry.h"

namespace hermite {

namespace {

CloudPoint to_cloud_point(const Surfel& surfel, const Rigid3& target_from_submap) {
  CloudPoint point;
  point.position_m = (target_from_submap * surfel.position_in_submap_m.cast<double>()).cast<float>();
  // Inside, normals point away from the camera; outside, everybody expects them towards it.
  point.normal = (target_from_submap.rotation * -surfel.normal_in_submap.cast<double>()).cast<float>();
  point.color = {surfel.r, surfel.g, surfel.b};
  point.confidence = surfel.confidence;
  point.curvature_max_per_m = surfel.curvature_max_per_m;
  point.curvature_min_per_m = surfel.curvature_min_per_m;
  point.radius_m = surfel.radius_m;
  point.submap = surfel.submap;
  return point;
}

Surfel to_surfel(const CloudPoint& point, std::uint32_t frame_number) {
  Surfel surfel;
  surfel.position_in_submap_m = point.position_m;
  surfel.normal_in_submap = -point.normal;
  surfel.radius_m = point.radius_m;
  surfel.confidence = point.confidence;
  surfel.curvature_max_per_m = point.curvature_max_per_m;
  surfel.curvature_min_per_m = point.curvature_min_per_m;
  surfel.r = point.color.r;
  surfel.g = point.color.g;
  surfel.b = point.color.b;
  surfel.created_frame = surfel.observed_frame = frame_number;
  return surfel;
}

Error wrong_size(const RgbdFrame& frame, const Camera& camera) {
  const auto size = [](int width, int height) { return std::to_string(width) + "x" + std::to_string(height); };
  return {ErrorCode::kInvalidArgument, "the frame is " + size(frame.depth.width, frame.depth.height) + " depth and " +
                                           size(frame.color.width, frame.color.height) + " colour, the camera " +
                                           size(camera.width, camera.height)};
}

const Camera& checked(const Camera& camera) {
  const Status valid = validate(camera);
  if (!valid.ok()) throw SetupError(valid.error());
  return camera;
}

std::optional<Undistorter> undistorter_of(const Camera& camera) {
  if (camera.distortion == Distortion{}) return std::nullopt;
  return Undistorter(camera);
}

struct Motion {
  OdometryResult odometry;
  Judgement judgement;
};

// A lost camera may also have turned away by a third of a usual field of view to all sides.
std::vector<Rigid3> with_turns(std::vector<Rigid3> guesses) {
  for (const double pitch_deg : {-12.0, 0.0, 12.0})
    for (const double yaw_deg : {-18.0, -9.0, 0.0, 9.0, 18.0})
      guesses.push_back(exp_se3((Vector6d() << 0, 0, 0, pitch_deg * M_PI / 180, yaw_deg * M_PI / 180, 0).finished()));
  return guesses;
}

}  // namespace

struct Pipeline::Impl {
  Impl(const std::string& device_choice, const Camera& camera_of_scan, const Options& options_of_scan, Timeline* timeline_of_scan)
      : camera(checked(camera_of_scan)),
        options(options_of_scan),
        undistorter(undistorter_of(camera)),
        timeline(timeline_of_scan),
        device(device_choice, timeline),
        commands(device),
        preprocessor(device, camera, options.frame),
        odometry(device, preprocessor.maps().camera(), options.track),
        store(device),
        visible(device, options.map),
        index(device, preprocessor.maps().camera()),
        fuser(device, preprocessor.maps().camera(), options.map, options.frame),
        predictor(device, preprocessor.maps().camera(), options.map) {}

  FrameResult process(const RgbdFrame& frame);
  std::vector<Rigid3> guesses(const Rigid3& turned) const;
  Motion track(const FrameMaps& maps, const FrameContent& content);
  void fuse(const FrameMaps& maps, bool with_color);
  void predict(const FrameMaps& maps, bool with_color);
  bool is_output(const Surfel& surfel) const {
    return surfel.confidence >= (options.output_unstable ? 1e-6 : options.map.stable_confidence);
  }

  // Runs `work`, waits for the GPU, and books the wall clock time under `stage`.
  template <class Work>
  void timed(const char* stage, Work work) {
    const auto start = std::chrono::steady_clock::now();
    work();
    commands.submit_and_wait();
    const double ms = std::chrono::duration<double, std::milli>(std::chrono::steady_clock::now() - start).count();
    stage_total_ms[stage] += ms;
    if (timeline) timeline->stages.push_back({stage, start, ms});
  }

  const Camera camera;
  const Options options;
  const std::optional<Undistorter> undistorter;  // when the lens distorts
  Timeline* const timeline;                      // of whoever wants one
  gpu::Device device;
  gpu::Commands commands;
  Preprocessor preprocessor;
  Odometry odometry;
  SurfelStore store;
  VisibleBlocks visible;
  IndexMap index;
  Fuser fuser;
  Predictor predictor;

  std::uint32_t frame_number = 0;  // of the map: frames fused so far, the first is 1
  Rigid3 world_from_camera;        // of the last tracked frame; the prediction is seen from here
  Rigid3 last_motion;              // reference_from_camera of the last tracked frame
  int lost_count = 0;              // frames lost since
  Trajectory trajectory;
  std::int64_t tracked_frame_count = 0, weak_frame_count = 0;
  double total_ms = 0;
  std::map<std::string, double> stage_total_ms;
  std::uint32_t changes_since = 0;
  std::vector<bool> published;  // by slot: take_changes() has reported it alive
};

// Where the camera may be, seen from where it was: turned as the pictures say, or moving on as before.
std::vector<Rigid3> Pipeline::Impl::guesses(const Rigid3& turned) const {
  std::vector<Rigid3> result{turned};
  if (options.track.constant_velocity) {
    result.push_back(last_motion);
    if (options.track.rotation_prealignment) result.push_back({turned.rotation, last_motion.translation});
  }
  return result;
}

Motion Pipeline::Impl::track(const FrameMaps& maps, const FrameContent& content) {
  TrackingEvidence evidence;
  evidence.content = content;
  evidence.lost_count = lost_count;
  const SurfacePyramid& reference = predictor.surface();
  if (frame_number == 0) {
    evidence.agreement = odometry.agreement(maps, reference, Rigid3{});
    return {{}, judge_start(evidence, options.track)};
  }
  Rigid3 turned;
  if (options.track.rotation_prealignment) turned.rotation = odometry.align_rotation(maps).conjugate();
  const std::vector<Rigid3> starts = guesses(turned);
  OdometryResult found;
  if (lost_count == 0) found = odometry.track(maps, reference, starts);
  if (!is_believable(found.agreement, options.track)) found = odometry.search(maps, reference, with_turns(starts));
  if (!is_believable(found.agreement, options.track)) evidence.unmoved = odometry.agreement(maps, reference, turned);
  evidence.agreement = found.agreement;
  evidence.inlier_share = found.agreement.surface * found.inlier_ratio;
  evidence.observability = found.observability;
  evidence.step_m = found.reference_from_camera.translation.norm();
  evidence.turn_rad = Eigen::AngleAxisd(found.reference_from_camera.rotation).angle();
  evidence.turn_seen_rad = Eigen::AngleAxisd(turned.rotation).angle();
  return {found, judge(evidence, options.track)};
}

void Pipeline::Impl::fuse(const FrameMaps& maps, bool with_color) {
  ++frame_number;
  store.reserve(fuser.new_slots_bound());
  store.set_camera(world_from_camera);
  visible.list(commands, store, maps.camera(), frame_number);
  index.build(commands, store, maps.camera(), 0);
  index.describe(commands, store, maps.camera());
  fuser.fuse(commands, maps, store, index, {frame_number, with_color});
}

void Pipeline::Impl::predict(const FrameMaps& maps, bool with_color) {
  visible.list(commands, store, maps.camera(), frame_number);
  index.build(commands, store, maps.camera(), options.map.stable_confidence);
  fuser.clean(commands, store, index, maps.camera(), frame_number);
  predictor.run(commands, store, index, maps, with_color);
  downsample(commands, preprocessor.downsample_kernel(), predictor.surface(), 0.5 * options.frame.depth_gate_m);
  odometry.remember(commands, maps);
}

FrameResult Pipeline::Impl::process(const RgbdFrame& frame) {
  const auto start = std::chrono::steady_clock::now();
  FrameResult result;
  result.frame_index = static_cast<std::int64_t>(trajectory.size());
  result.timestamp_s = frame.timestamp_s;

  timed("preprocess", [&] { preprocessor.run(commands, undistorter ? undistorter->apply(frame) : frame, result.frame_index); });
  const FrameMaps& maps = preprocessor.maps();
  const FrameContent content = content_of(frame, camera.depth_units_per_metre, options.frame);
  Motion motion;
  timed("track", [&] { motion = track(maps, content); });
  const bool lost = motion.judgement.status == TrackingStatus::kLost;
  lost_count = lost ? lost_count + 1 : 0;
  if (!lost) {
    world_from_camera = world_from_camera * motion.odometry.reference_from_camera;
    last_motion = motion.odometry.reference_from_camera;
    timed("fuse", [&] { fuse(maps, motion.judgement.picture_is_good); });
    timed("predict", [&] { predict(maps, motion.judgement.picture_is_good); });
    ++tracked_frame_count;
    weak_frame_count += motion.judgement.status == TrackingStatus::kWeak ? 1 : 0;
  }

  result.status = motion.judgement.status;
  result.reason = motion.judgement.reason;
  result.world_from_camera = world_from_camera;
  result.inlier_count = motion.odometry.inlier_count;
  result.inlier_ratio = motion.odometry.inlier_ratio;
  result.residual_rms_m = motion.odometry.residual_rms_m;
  result.surfel_count = store.alive_count();
  trajectory.push_back({frame.timestamp_s, world_from_camera});
  total_ms += std::chrono::duration<double, std::milli>(std::chrono::steady_clock::now() - start).count();
  return result;
}

Pipeline::Pipeline(const std::string& device, const Camera& camera, const Options& options, Timeline* timeline)
    : impl_(std::make_unique<Impl>(device, camera, options, timeline)) {}
Pipeline::~Pipeline() = default;

Result<FrameResult> Pipeline::process(const RgbdFrame& frame) {
  const Camera& camera = impl_->camera;
  const auto fits = [&camera](int width, int height) { return width == camera.width && height == camera.height; };
  if (!fits(frame.depth.width, frame.depth.height) || !fits(frame.color.width, frame.color.height)) return wrong_size(frame, camera);
  try {
    return impl_->process(frame);
  } catch (const SetupError& error) {
    return error.error();
  }
}

Status Pipeline::insert(const Cloud& cloud) {
  try {
    std::vector<Surfel> surfels;
    for (const CloudPoint& point : cloud)
      if (point.confidence > 0) surfels.push_back(to_surfel(point, impl_->frame_number + 1));
    impl_->store.append(surfels);
    return Done{};
  } catch (const SetupError& error) {
    return error.error();
  }
}

const Trajectory& Pipeline::trajectory() const { return impl_->trajectory; }

Result<Cloud> Pipeline::cloud() {
  try {
    Cloud cloud;
    for (const Surfel& surfel : impl_->store.download())
      if (impl_->is_output(surfel)) cloud.push_back(to_cloud_point(surfel, impl_->store.world_from_submap()[surfel.submap]));
    return cloud;
  } catch (const SetupError& error) {
    return error.error();
  }
}

Result<std::vector<SlotChange>> Pipeline::take_changes() {
  Impl& impl = *impl_;
  try {
    std::vector<SlotChange> changes;
    const std::vector<Surfel> surfels = impl.store.download();
    impl.published.resize(surfels.size(), false);
    for (std::size_t slot = 0; slot < surfels.size(); ++slot) {
      const Surfel& surfel = surfels[slot];
      if (surfel.observed_frame <= impl.changes_since) continue;
      const bool alive = impl.is_output(surfel);
      if (alive || impl.published[slot])
        changes.push_back({static_cast<std::uint32_t>(slot), alive, alive ? to_cloud_point(surfel, Rigid3{}) : CloudPoint{}});
      impl.published[slot] = alive;
    }
    impl.changes_since = impl.frame_number;
    return changes;
  } catch (const SetupError& error) {
    return error.error();
  }
}

std::vector<SubmapPose> Pipeline::submap_poses() const {
  std::vector<SubmapPose> poses;
  for (const Rigid3& pose : impl_->store.world_from_submap()) poses.push_back({static_cast<std::uint32_t>(poses.size()), pose});
  return poses;
}

PipelineStatistics Pipeline::statistics() const {
  const Impl& impl = *impl_;
  PipelineStatistics statistics;
  statistics.frame_count = static_cast<std::int64_t>(impl.trajectory.size());
  statistics.tracked_frame_count = impl.tracked_frame_count;
  statistics.weak_frame_count = impl.weak_frame_count;
  statistics.surfel_count = impl.store.alive_count();
  statistics.surfel_slot_count = impl.store.slot_count();
  statistics.surfel_capacity = impl.store.capacity();
  const double frames = static_cast<double>(std::max<std::size_t>(impl.trajectory.size(), 1));
  statistics.mean_frame_ms = impl.total_ms / frames;
  for (const auto& [stage, ms] : impl.stage_total_ms) statistics.stages_ms[stage] = ms / frames;
  for (const auto& pass : impl.device.pass_times()) statistics.gpu_passes_ms[pass.kernel] = pass.total_ms / frames;
  statistics.gpu_memory_bytes = impl.device.memory_by_purpose();
  statistics.device = impl.device.info().name;
  return statistics;
}

}  // namespace hermite
