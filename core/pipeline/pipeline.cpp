#include "core/pipeline/pipeline.h"

#include <algorithm>
#include <chrono>
#include <optional>
#include <set>
#include <utility>

#include "core/frame/rectify.h"
#include "core/math/rigid3_fields.h"
#include "core/pipeline/checkpoint.h"
#include "core/pipeline/cloud_points.h"
#include "core/pipeline/front_end.h"

namespace hermite {

namespace {

bool has_size_of(const Camera& camera, const RgbdFrame& frame) {
  const auto fits = [&camera](int width, int height) { return width == camera.width && height == camera.height; };
  return fits(frame.depth.width, frame.depth.height) && fits(frame.color.width, frame.color.height);
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

std::size_t part_count(const MapLayout& layout) { return std::set(layout.part.begin(), layout.part.end()).size(); }

// Of a frame that nothing new was taken from.
Judgement of_full_map(Judgement tracked) {
  tracked.status = TrackingStatus::kWeak;
  tracked.reason += (tracked.reason.empty() ? "" : "; ") +
                    std::string("the map is full: the device memory that may be used has no room for what is new around the camera");
  return tracked;
}

// A tenth of what tells that something has moved (core/track/moving_regions.cpp).
constexpr double kCorrectionThatMovesViews_m = 0.003;

// The frame as the back end gets it: no depth where something moves.
RgbdFrame without_moving(const RgbdFrame& frame, const FrontEnd& front_end) {
  RgbdFrame rest = frame;
  const shared::Intrinsics& coarse = front_end.coarse_view().camera;
  const int width = static_cast<int>(coarse.width), height = static_cast<int>(coarse.height);
  for (int y = 0; y < frame.depth.height; ++y)
    for (int x = 0; x < frame.depth.width; ++x)
      if (front_end.moving()[front_end.coarse_view().index(x * width / frame.depth.width, y * height / frame.depth.height)] != 0)
        rest.depth.at(x, y) = 0;
  return rest;
}

double farthest_correction_m(const std::vector<Rigid3>& before, const MapLayout& layout) {
  double farthest_m = 0;
  for (std::size_t submap = 0; submap < before.size(); ++submap)
    if (layout.is_active[submap])
      farthest_m = std::max(farthest_m, (layout.world_from_submap[submap].translation - before[submap].translation).norm());
  return farthest_m;
}

}  // namespace

struct Pipeline::Impl {
  Impl(const std::string& device, const Camera& camera_of_scan, const Options& options_of_scan, std::unique_ptr<Mapping> mapping_of_scan,
       Timeline* timeline_of_scan)
      : camera(checked(camera_of_scan)),
        options(options_of_scan),
        rectifier(rectifier_of(camera)),
        timeline(timeline_of_scan),
        mapping(std::move(mapping_of_scan)),
        front_end(device, camera, options, timeline) {}

  PreparedFrame prepare(RgbdFrame frame) const;
  FrameResult process(const PreparedFrame& prepared);
  Conditions conditions() const { return conditions_of(front_end.device.info(), camera, options, mapping != nullptr); }
  template <class Bytes, class Saved>
  static void fields(Bytes& bytes, Saved& saved);
  Status restore(ByteReader& bytes);
  MapEvent observe(const RgbdFrame& frame, const Rigid3& tracked);
  MapEvent find(const RgbdFrame& frame, const FrameContent& content, Motion& motion);
  void describe_pose(FrameResult& result) const;
  void weigh(Motion& motion, FrameResult& result);
  void remember(double timestamp_s);
  void follow_corrections();
  const MapLayout& layout() const { return mapping ? mapping->layout() : one_submap; }
  bool is_output(const Surfel& surfel) const {
    return surfel.confidence >= (options.output_unstable ? 1e-6 : options.map.stable_confidence);
  }

  // Runs `work`, waits for the GPU, and books the wall clock time under `stage`.
  template <class Work>
  void timed(const char* stage, Work work) {
    const auto start = std::chrono::steady_clock::now();
    work();
    front_end.commands.submit_and_wait();
    const double ms = std::chrono::duration<double, std::milli>(std::chrono::steady_clock::now() - start).count();
    stage_total_ms[stage] += ms;
    if (timeline) timeline->stages.push_back({stage, start, ms});
  }

  const Camera camera;
  const Options options;
  const std::optional<Rectifier> rectifier;  // when frames do not arrive straight and registered
  Timeline* const timeline;                  // of whoever wants one
  const std::unique_ptr<Mapping> mapping;    // none: one submap, which never moves
  const MapLayout one_submap;
  FrontEnd front_end;

  Rigid3 world_from_camera;     // of the last tracked frame; the prediction is seen from here
  Rigid3 last_motion;           // reference_from_camera of the last tracked frame
  int lost_count = 0;           // frames lost since
  PoseUncertainty uncertainty;  // of the last tracked frame
  std::vector<AnchoredPose> poses;
  Trajectory trajectory;  // `poses` in the world, as of correction_count
  std::uint64_t correction_count = 0;
  std::int64_t tracked_frame_count = 0, weak_frame_count = 0;
  std::int64_t timed_frame_count = 0;  // that the next two are of, and the device's clocks: since restore()
  double total_ms = 0;
  std::map<std::string, double> stage_total_ms;
  std::uint32_t changes_since = 0;
  std::vector<bool> published;  // by slot: take_changes() has reported it alive
};

// What the back end makes of a tracked frame: submaps are opened and moved, loops closed.
MapEvent Pipeline::Impl::observe(const RgbdFrame& frame, const Rigid3& tracked) {
  const std::uint32_t submap = layout().current;
  const Rigid3 submap_from_camera = inverse(layout().world_from_submap[submap]) * tracked;
  const std::size_t parts_before = part_count(layout());
  const std::uint64_t closures_before = layout().closure_count;
  for (const Revisit& revisit : mapping->observe(without_moving(frame, front_end), tracked)) {
    const std::optional<Look> look = front_end.look(revisit, layout());
    if (look && mapping->confirm(revisit, *look)) break;  // the others were guessed from how the map was before
  }
  world_from_camera = layout().world_from_submap[submap] * submap_from_camera;
  if (part_count(layout()) < parts_before) return MapEvent::kJoined;
  return layout().closure_count > closures_before ? MapEvent::kLoopClosed : MapEvent::kNone;
}

// A lost camera is found, or the map goes on in a new part.
MapEvent Pipeline::Impl::find(const RgbdFrame& frame, const FrameContent& content, Motion& motion) {
  const std::vector<Revisit> revisits = mapping->find(frame);
  for (const Revisit& revisit : revisits) {
    const std::optional<Look> look = front_end.look(revisit, layout());
    if (!look) continue;
    mapping->found(revisit, look->world_from_camera);
    world_from_camera = look->world_from_camera;
    front_end.forget_corners();
    motion = {{}, {TrackingStatus::kWeak, "found again"}};
    return MapEvent::kFoundAgain;
  }
  if (lost_count + 1 >= options.adjust.new_part_after_frames && front_end.judge_start(content).status != TrackingStatus::kLost) {
    mapping->begin_part(world_from_camera);
    front_end.forget_corners();
    motion = {{}, {TrackingStatus::kWeak, "not found: a new part of the map begins, to be joined when the camera sees both"}};
    return MapEvent::kNewPart;
  }
  if (!revisits.empty()) front_end.predict(world_from_camera, layout());  // which the looks have overwritten
  return MapEvent::kNone;
}

// What is known of the frame's pose, and whether that is enough to call it tracked.
void Pipeline::Impl::weigh(Motion& motion, FrameResult& result) {
  if (result.event == MapEvent::kNewPart) front_end.begin_part();
  uncertainty = front_end.uncertainty_at(world_from_camera, motion.odometry, layout());
  result.uncertainty = uncertainty;
  motion.judgement =
      weighed(std::move(motion.judgement), {uncertainty, front_end.calibration_doubt(), contradiction(motion.odometry.witnesses)});
}

void Pipeline::Impl::remember(double timestamp_s) {
  poses.push_back({timestamp_s, layout().current, inverse(layout().world_from_submap[layout().current]) * world_from_camera});
  trajectory.push_back({timestamp_s, world_from_camera});
  follow_corrections();
}

void Pipeline::Impl::follow_corrections() {
  if (correction_count == layout().correction_count) return;
  correction_count = layout().correction_count;
  for (std::size_t i = 0; i < poses.size(); ++i)
    trajectory[i].world_from_camera = layout().world_from_submap[poses[i].submap] * poses[i].submap_from_camera;
}

// Of the frame that was remembered last.
void Pipeline::Impl::describe_pose(FrameResult& result) const {
  result.world_from_camera = trajectory.back().world_from_camera;
  result.submap = poses.back().submap;
  result.submap_from_camera = poses.back().submap_from_camera;
  result.last_tracked_frame = result.frame_index - lost_count;
  if (result.last_tracked_frame >= 0)
    result.last_tracked_timestamp_s = poses[static_cast<std::size_t>(result.last_tracked_frame)].timestamp_s;
}

PreparedFrame Pipeline::Impl::prepare(RgbdFrame frame) const {
  const FrameContent content = content_of(frame, camera.depth_units_per_metre, options.frame);
  const NoiseSample noise = measure_noise(frame.depth, camera.depth_units_per_metre, options.frame);
  RgbdFrame straight = rectifier ? rectifier->apply(frame) : std::move(frame);
  PictureFeatures features = features_of(straight, camera.depth_units_per_metre, options.frame);
  return {std::move(straight), content, noise, std::move(features)};
}

FrameResult Pipeline::Impl::process(const PreparedFrame& prepared) {
  const auto start = std::chrono::steady_clock::now();
  const RgbdFrame& frame = prepared.frame;
  const FrameContent& content = prepared.content;
  FrameResult result;
  result.frame_index = static_cast<std::int64_t>(trajectory.size());
  result.timestamp_s = frame.timestamp_s;

  timed("preprocess", [&] { front_end.preprocess(prepared, result.frame_index); });
  const std::vector<Rigid3> poses_before = layout().world_from_submap;
  Motion motion;
  timed("track", [&] { motion = front_end.track(content, prepared.features, frame.depth, world_from_camera, last_motion, lost_count); });
  if (motion.judgement.status != TrackingStatus::kLost) world_from_camera = world_from_camera * motion.odometry.reference_from_camera;
  if (mapping && motion.judgement.status != TrackingStatus::kLost)
    timed("adjust", [&] { result.event = observe(frame, world_from_camera); });
  if (mapping && motion.judgement.status == TrackingStatus::kLost) timed("find", [&] { result.event = find(frame, content, motion); });

  const bool lost = motion.judgement.status == TrackingStatus::kLost;
  if (lost != (lost_count > 0) && tracked_frame_count > 0 && result.event == MapEvent::kNone)
    result.event = lost ? MapEvent::kLost : MapEvent::kFoundAgain;
  result.correction_m = farthest_correction_m(poses_before, layout());
  if (lost || result.event != MapEvent::kNone || result.correction_m > kCorrectionThatMovesViews_m) front_end.forget_views();
  if (!lost) weigh(motion, result);
  if (!lost) front_end.remember_view(world_from_camera, motion.odometry.reference_from_camera, prepared);
  lost_count = lost ? lost_count + 1 : 0;
  if (!lost) {
    last_motion = motion.odometry.reference_from_camera;
    const PictureUse picture{motion.judgement.picture_is_good, motion.odometry.brightness};
    bool is_full = false;
    timed("fuse", [&] { is_full = !front_end.fuse(world_from_camera, layout(), picture); });
    if (is_full) motion.judgement = of_full_map(std::move(motion.judgement));
    timed("predict", [&] { front_end.clean_and_predict(picture); });
    ++tracked_frame_count;
    weak_frame_count += motion.judgement.status == TrackingStatus::kWeak ? 1 : 0;
  }

  result.status = motion.judgement.status;
  result.reason = motion.judgement.reason;
  result.inlier_count = motion.odometry.inlier_count;
  result.inlier_ratio = motion.odometry.inlier_ratio;
  result.residual_rms_m = motion.odometry.residual_rms_m;
  result.surfel_count = front_end.store.surfel_count();
  remember(frame.timestamp_s);
  describe_pose(result);
  ++timed_frame_count;
  total_ms += std::chrono::duration<double, std::milli>(std::chrono::steady_clock::now() - start).count();
  return result;
}

template <class Bytes, class Saved>
void Pipeline::Impl::fields(Bytes& bytes, Saved& saved) {
  rigid3_fields(bytes, saved.world_from_camera);
  rigid3_fields(bytes, saved.last_motion);
  bytes.number(saved.lost_count);
  bytes.numbers(saved.uncertainty.second_moment.data(), 36);
  bytes.number(saved.uncertainty.way_m);
  bytes.list(saved.poses, [](auto& to, auto& pose) {
    to.number(pose.timestamp_s);
    to.number(pose.submap);
    rigid3_fields(to, pose.submap_from_camera);
  });
  bytes.list(saved.trajectory, [](auto& to, auto& pose) {
    to.number(pose.timestamp_s);
    rigid3_fields(to, pose.world_from_camera);
  });
  bytes.number(saved.correction_count);
  bytes.number(saved.tracked_frame_count);
  bytes.number(saved.weak_frame_count);
  bytes.number(saved.changes_since);
  bytes.flags(saved.published);
}

Status Pipeline::Impl::restore(ByteReader& bytes) {
  if (Status same = read_head(bytes, conditions()); !same.ok()) return same;
  fields(bytes, *this);
  if (mapping) mapping->restore(bytes);
  front_end.restore(bytes);
  const auto frames = static_cast<std::int64_t>(poses.size());
  const std::size_t submaps = layout().world_from_submap.size();
  bytes.require(poses.size() == trajectory.size() && tracked_frame_count >= 0 && tracked_frame_count <= frames && weak_frame_count >= 0 &&
                    weak_frame_count <= frames && lost_count >= 0 && lost_count <= frames,
                "the number of frames");
  bytes.require(std::all_of(poses.begin(), poses.end(), [submaps](const AnchoredPose& pose) { return pose.submap < submaps; }) &&
                    front_end.store.world_from_submap().size() <= submaps,
                "the number of submaps");
  bytes.require(bytes.at_end(), "more than a checkpoint");
  return bytes.status();
}

const char* name_of(MapEvent event) {
  switch (event) {
    case MapEvent::kNone: return "";
    case MapEvent::kLost: return "lost";
    case MapEvent::kFoundAgain: return "found again";
    case MapEvent::kNewPart: return "new part";
    case MapEvent::kJoined: return "joined";
    case MapEvent::kLoopClosed: return "loop closed";
  }
  return "";
}

Pipeline::Pipeline(const std::string& device, const Camera& camera, const Options& options, std::unique_ptr<Mapping> mapping,
                   Timeline* timeline)
    : impl_(std::make_unique<Impl>(device, camera, options, std::move(mapping), timeline)) {}
Pipeline::~Pipeline() = default;

Result<PreparedFrame> Pipeline::prepare(RgbdFrame frame) const {
  if (!has_size_of(impl_->camera, frame)) return wrong_size(frame, impl_->camera);
  return impl_->prepare(std::move(frame));
}

Result<FrameResult> Pipeline::process(const PreparedFrame& prepared) {
  if (!has_size_of(impl_->camera, prepared.frame)) return wrong_size(prepared.frame, impl_->camera);
  try {
    return impl_->process(prepared);
  } catch (const SetupError& error) {
    return error.error();
  }
}

Result<FrameResult> Pipeline::process(RgbdFrame frame) {
  const Result<PreparedFrame> prepared = prepare(std::move(frame));
  return prepared.ok() ? process(*prepared) : prepared.error();
}

void Pipeline::finish() {
  if (!impl_->mapping) return;
  impl_->mapping->finish();
  impl_->front_end.store.set_submaps(impl_->layout().world_from_submap);
  impl_->follow_corrections();
}

Result<std::string> Pipeline::save() const {
  try {
    ByteWriter bytes;
    write_head(bytes, impl_->conditions());
    Impl::fields(bytes, std::as_const(*impl_));
    if (impl_->mapping) impl_->mapping->save(bytes);
    impl_->front_end.save(bytes);
    return bytes.take();
  } catch (const SetupError& error) {
    return error.error();
  }
}

Status Pipeline::restore(std::string_view bytes) {
  CHECK(impl_->trajectory.empty(), "a pipeline that has seen frames cannot go on from others");
  try {
    ByteReader reader(bytes);
    const Status restored = impl_->restore(reader);
    return restored.ok() ? restored : in_context("checkpoint", restored.error());
  } catch (const SetupError& error) {
    return error.error();
  }
}

Status Pipeline::insert(const Cloud& cloud) {
  try {
    std::vector<Surfel> surfels;
    for (const CloudPoint& point : cloud)
      if (point.confidence > 0) surfels.push_back(to_surfel(point, impl_->front_end.frame_number + 1));
    impl_->front_end.store.append(surfels);
    return Done{};
  } catch (const SetupError& error) {
    return error.error();
  }
}

const Trajectory& Pipeline::trajectory() const { return impl_->trajectory; }
std::vector<AnchoredPose> Pipeline::anchored_poses() const { return impl_->poses; }

Result<Cloud> Pipeline::cloud() {
  try {
    Cloud cloud;
    for (const auto& [number, surfel, changed_frame] : impl_->front_end.store.changed_blocks(0))
      if (impl_->is_output(surfel)) cloud.push_back(to_cloud_point(surfel, impl_->layout().world_from_submap[surfel.submap]));
    return cloud;
  } catch (const SetupError& error) {
    return error.error();
  }
}

Result<std::vector<SlotChange>> Pipeline::take_changes() {
  Impl& impl = *impl_;
  try {
    std::vector<SlotChange> changes;
    for (const auto& [number, surfel, changed_frame] : impl.front_end.store.changed_blocks(impl.changes_since)) {
      if (changed_frame <= impl.changes_since) continue;
      if (impl.published.size() <= number) impl.published.resize(number + kSlotsPerBlock, false);
      const bool alive = impl.is_output(surfel);
      if (alive || impl.published[number]) changes.push_back({number, alive, alive ? to_cloud_point(surfel, Rigid3{}) : CloudPoint{}});
      impl.published[number] = alive;
    }
    impl.changes_since = impl.front_end.frame_number;
    return changes;
  } catch (const SetupError& error) {
    return error.error();
  }
}

void Pipeline::forget_taken_changes() {
  impl_->changes_since = 0;
  impl_->published.clear();
}

std::vector<SubmapPose> Pipeline::submap_poses() const {
  std::vector<SubmapPose> poses;
  for (const Rigid3& pose : impl_->front_end.store.world_from_submap())
    poses.push_back({static_cast<std::uint32_t>(poses.size()), pose, impl_->layout().part[poses.size()]});
  return poses;
}

PipelineStatistics Pipeline::statistics() const {
  const Impl& impl = *impl_;
  PipelineStatistics statistics;
  statistics.frame_count = static_cast<std::int64_t>(impl.trajectory.size());
  statistics.tracked_frame_count = impl.tracked_frame_count;
  statistics.weak_frame_count = impl.weak_frame_count;
  statistics.position_sigma_m = impl.uncertainty.position_sigma_m();
  statistics.rotation_sigma_rad = impl.uncertainty.rotation_sigma_rad();
  statistics.calibration_doubt = impl.front_end.calibration_doubt().reason();
  statistics.surfel_count = impl.front_end.store.surfel_count();
  statistics.surfel_slot_count = impl.front_end.store.slot_count();
  statistics.surfel_capacity = impl.front_end.store.capacity();
  const double frames = static_cast<double>(std::max<std::int64_t>(impl.timed_frame_count, 1));
  statistics.mean_frame_ms = impl.total_ms / frames;
  for (const auto& [stage, ms] : impl.stage_total_ms) statistics.stages_ms[stage] = ms / frames;
  for (const auto& pass : impl.front_end.device.pass_times()) statistics.gpu_passes_ms[pass.kernel] = pass.total_ms / frames;
  statistics.gpu_memory_bytes = impl.front_end.device.memory_by_purpose();
  const gpu::DeviceInfo& device = impl.front_end.device.info();
  if (device.kind != gpu::DeviceKind::kCpu) statistics.device_memory_bytes = static_cast<std::int64_t>(device.all_memory_bytes);
  statistics.host_memory_bytes = impl.front_end.store.host_bytes();
  if (impl.mapping) {
    statistics.mapping = impl.mapping->counts();
    statistics.mapping["parts"] = static_cast<std::int64_t>(part_count(impl.layout()));
  }
  statistics.device = device.name;
  return statistics;
}

}  // namespace hermite
