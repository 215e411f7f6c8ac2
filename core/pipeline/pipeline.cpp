#include "core/pipeline/pipeline.h"

#include <mutex>
#include <optional>
#include <utility>

#include "core/base/read_ahead.h"
#include "core/calibrate/camera_numbers.h"
#include "core/pipeline/camera_correction.h"
#include "core/pipeline/camera_doubts.h"
#include "core/pipeline/checkpoint.h"
#include "core/pipeline/cloud_points.h"
#include "core/pipeline/frame_preparer.h"
#include "core/pipeline/map_changes.h"
#include "core/pipeline/reconstruction.h"

namespace hermite::pipeline {

namespace {

const Camera& checked(const Camera& camera) {
  const Status valid = validate(camera);
  if (!valid.ok()) throw SetupError(valid.error());
  return camera;
}

// The given camera and its corrections. The shape, the rows of depth and those of colour may each
// be confirmed at another time.
constexpr std::uint32_t kMostCameras = 4;

constexpr std::size_t kFramesAhead = 4;  // during reprocessing

BackEnd with_one(std::unique_ptr<adjust::Mapping> mapping) {
  BackEnd back_end;
  const auto only = std::make_shared<std::unique_ptr<adjust::Mapping>>(std::move(mapping));
  back_end.mapping = [only](const Camera&) { return std::move(*only); };
  return back_end;
}

}  // namespace

struct Pipeline::Impl {
  Impl(std::string device_choice, const Camera& camera, const Options& options_of_scan,
       BackEnd parts, Timeline* timeline_of_scan)
      : device(std::move(device_choice)),
        options(options_of_scan),
        back_end(std::move(parts)),
        timeline(timeline_of_scan),
        given_camera(checked(camera)) {
    begin_with(given_camera);
  }

  std::shared_ptr<const FramePreparer> current_preparer() const {
    const std::lock_guard lock(preparer_mutex);
    return preparer;
  }
  Conditions conditions() const {
    return conditions_of(reconstruction->front_end.device.info(), given_camera, options,
                         reconstruction->mapping != nullptr);
  }
  void begin_with(const Camera& camera);
  FrameResult process(const frame::PreparedFrame& prepared);
  FrameResult process_whole_rows(const frame::PreparedFrame& prepared);
  void learn_shape(const calibrate::CameraCheck& check);
  PastFrames correct_camera(const calibrate::CameraCheck& check);
  std::optional<FrameResult> follow(const calibrate::CameraCheck& check);
  FrameResult reprocess(const dataset::Trajectory& given, PastFrames past_frames);
  template <class Bytes, class Saved>
  static void camera_fields(Bytes& bytes, Saved& camera);
  template <class Bytes, class Saved>
  static void change_fields(Bytes& bytes, Saved& saved);
  Status restore(ByteReader& bytes);
  bool is_meshed(const map::Surfel& surfel) const {
    return surfel.confidence >= kMeshedConfidence || reconstruction->is_output(surfel);
  }
  Result<output::Cloud> cloud_of(const std::function<bool(const map::Surfel&)>& is_wanted);

  const std::string device;
  const Options options;
  const BackEnd back_end;
  Timeline* const timeline;
  const Camera given_camera;
  bool takes_camera_as_it_is = false;
  std::uint32_t camera_count = 0;
  mutable std::mutex preparer_mutex;
  std::shared_ptr<const FramePreparer> preparer;  // guarded by preparer_mutex
  std::unique_ptr<Reconstruction> reconstruction;
  frame::TornFrames torn_frames;
  MapChanges changes;
};

// Starts over with this camera and an empty map.
void Pipeline::Impl::begin_with(const Camera& camera) {
  reconstruction.reset();  // frees its memory first
  const bool is_watched =
      back_end.camera_watch && options.frame.correct_camera && !takes_camera_as_it_is;
  reconstruction = std::make_unique<Reconstruction>(
      device, camera, options, back_end.mapping ? back_end.mapping(camera) : nullptr,
      is_watched ? back_end.camera_watch(camera) : nullptr, timeline);
  reconstruction->front_end.certainty().begin_with(believed(camera.deviations));
  auto next = std::make_shared<const FramePreparer>(camera, options, camera_count++);
  torn_frames = {};
  changes.begin_map(camera_count > 1);
  const std::lock_guard lock(preparer_mutex);
  preparer = std::move(next);
}

// Processes a frame without the rows that are left from the frame before, for the current camera.
FrameResult Pipeline::Impl::process_whole_rows(const frame::PreparedFrame& prepared) {
  const std::shared_ptr<const FramePreparer> current = current_preparer();
  const int repeated_row_count = torn_frames.next(prepared.rows);
  if (repeated_row_count == 0 && prepared.camera_number == current->number())
    return reconstruction->process(prepared);
  frame::PreparedFrame whole = current->prepare_again(prepared, repeated_row_count);
  whole.repeated_share = repeated_row_count / static_cast<double>(current->camera().height);
  return reconstruction->process(whole);
}

FrameResult Pipeline::Impl::process(const frame::PreparedFrame& prepared) {
  FrameResult result = process_whole_rows(prepared);
  if (!reconstruction->watch) return result;
  const std::optional<calibrate::CameraCheck> check = reconstruction->watch->answer();
  if (!check) return result;
  return follow(*check).value_or(std::move(result));
}

// Takes what a check says of the shape of the current camera.
void Pipeline::Impl::learn_shape(const calibrate::CameraCheck& check) {
  track::MapCertainty& certainty = reconstruction->front_end.certainty();
  if (const std::optional<calibrate::MeasuredShape>& shape = check.measured)
    certainty.observe_camera(doubts_of(shape->errors), doubts_of(shape->deviations));
  else
    certainty.forget_calibration();
}

// Starts over with the corrected camera and returns access to the past frames. Returns an empty
// function if the camera stays as it is; its calibration is then in doubt.
PastFrames Pipeline::Impl::correct_camera(const calibrate::CameraCheck& check) {
  Camera better = calibrate::changed(current_preparer()->camera(), check.change);
  better.deviations = {};  // were those of the camera that is corrected
  PastFrames past_frames;
  if (back_end.past_frames && !takes_camera_as_it_is && camera_count < kMostCameras &&
      validate(better).ok())
    past_frames = back_end.past_frames();
  if (past_frames) {
    begin_with(better);
    learn_shape(check);
  } else {
    reconstruction->front_end.certainty().camera_is_off(
        -check.change[calibrate::kBend],
        {-check.change[calibrate::kFocal], -check.change[calibrate::kRadial],
         check.change.tail<calibrate::kTimingNumberCount>().cwiseAbs().maxCoeff()});
  }
  return past_frames;
}

// Acts on a result of the camera watch. Returns the new result of the last frame if it was
// reprocessed.
std::optional<FrameResult> Pipeline::Impl::follow(const calibrate::CameraCheck& check) {
  if (check.verdict != calibrate::CameraVerdict::kIsOff) {
    learn_shape(check);
    return std::nullopt;
  }
  const dataset::Trajectory given = reconstruction->poses.trajectory();
  PastFrames past_frames = correct_camera(check);
  if (!past_frames) return std::nullopt;
  FrameResult result = reprocess(given, std::move(past_frames));
  result.event = MapEvent::kRecalibrated;
  result.correction_m =
      (result.world_from_camera.translation - given.back().world_from_camera.translation).norm();
  return result;
}

// Reprocesses the frames with these timestamps, correcting the camera again if needed. Returns the
// result of the last frame.
FrameResult Pipeline::Impl::reprocess(const dataset::Trajectory& given, PastFrames past_frames) {
  FrameResult result;
  while (past_frames) {
    const std::shared_ptr<const FramePreparer> current = current_preparer();
    const PastFrames frames = std::exchange(past_frames, nullptr);
    const auto prepare = [&](std::int64_t index) {
      const double timestamp_s = given[static_cast<std::size_t>(index)].timestamp_s;
      Result<frame::RgbdFrame> frame = frames(index, timestamp_s);
      const bool is_usable =
          frame.ok() && frame->timestamp_s == timestamp_s && current->check(*frame).ok();
      return is_usable ? current->prepare(*std::move(frame)) : current->empty(timestamp_s);
    };
    ReadAhead<frame::PreparedFrame> reader(0, static_cast<std::int64_t>(given.size()), kFramesAhead,
                                           prepare);
    while (const std::optional<frame::PreparedFrame> prepared =
               past_frames ? std::nullopt : reader.next()) {
      result = process_whole_rows(*prepared);
      const std::optional<calibrate::CameraCheck> check =
          reconstruction->watch ? reconstruction->watch->answer() : std::nullopt;
      if (!check) continue;
      if (check->verdict == calibrate::CameraVerdict::kIsOff)
        past_frames = correct_camera(*check);
      else
        learn_shape(*check);
    }
  }
  return result;
}

template <class Bytes, class Saved>
void Pipeline::Impl::camera_fields(Bytes& bytes, Saved& camera) {
  bytes.number(camera.fx);
  bytes.number(camera.fy);
  bytes.number(camera.distortion.k1);
  bytes.number(camera.depth_correction.bend);
  bytes.number(camera.timing.depth_readout_s);
  bytes.number(camera.timing.color_readout_s);
  bytes.number(camera.timing.color_delay_s);
}

template <class Bytes, class Saved>
void Pipeline::Impl::change_fields(Bytes& bytes, Saved& saved) {
  bytes.number(saved.changes.taken_frame);
  bytes.flags(saved.changes.published);
  bytes.flag(saved.takes_camera_as_it_is);
  bytes.flag(saved.changes.is_map_new);
}

Status Pipeline::Impl::restore(ByteReader& bytes) {
  if (Status same = read_head(bytes, conditions()); !same.ok()) return same;
  std::uint32_t saved_camera_count = 0;
  Camera camera = given_camera;
  bytes.number(saved_camera_count);
  camera_fields(bytes, camera);
  bytes.require(
      saved_camera_count >= 1 && saved_camera_count <= kMostCameras && validate(camera).ok(),
      "the camera is invalid");
  if (!bytes.ok()) return bytes.status();
  if (saved_camera_count > 1) {
    camera_count = saved_camera_count - 1;
    camera.deviations = {};
    begin_with(camera);
  }
  change_fields(bytes, *this);
  torn_frames.restore(bytes);
  reconstruction->restore(bytes);
  bytes.require(bytes.at_end(), "there are bytes after the checkpoint");
  return bytes.status();
}

Pipeline::Pipeline(const std::string& device, const Camera& camera, const Options& options,
                   BackEnd back_end, Timeline* timeline)
    : impl_(std::make_unique<Impl>(device, camera, options, std::move(back_end), timeline)) {}
Pipeline::Pipeline(const std::string& device, const Camera& camera, const Options& options,
                   std::unique_ptr<adjust::Mapping> mapping, Timeline* timeline)
    : Pipeline(device, camera, options, with_one(std::move(mapping)), timeline) {}
Pipeline::~Pipeline() = default;

Result<frame::PreparedFrame> Pipeline::prepare(frame::RgbdFrame frame) const {
  const std::shared_ptr<const FramePreparer> preparer = impl_->current_preparer();
  if (const Status fits = preparer->check(frame); !fits.ok()) return fits.error();
  return preparer->prepare(std::move(frame));
}

Result<FrameResult> Pipeline::process(const frame::PreparedFrame& prepared) {
  if (const Status fits = impl_->current_preparer()->check(prepared.frame); !fits.ok())
    return fits.error();
  try {
    return impl_->process(prepared);
  } catch (const SetupError& error) {
    return error.error();
  }
}

Result<FrameResult> Pipeline::process(frame::RgbdFrame frame) {
  const Result<frame::PreparedFrame> prepared = prepare(std::move(frame));
  return prepared.ok() ? process(*prepared) : prepared.error();
}

void Pipeline::finish() {
  if (impl_->reconstruction->watch)
    if (const std::optional<calibrate::CameraCheck> check =
            impl_->reconstruction->watch->last_answer())
      impl_->follow(*check);
  impl_->reconstruction->finish();
}

Result<std::string> Pipeline::save() const {
  try {
    ByteWriter bytes;
    write_head(bytes, impl_->conditions());
    bytes.number(impl_->camera_count);
    Impl::camera_fields(bytes, impl_->current_preparer()->camera());
    Impl::change_fields(bytes, std::as_const(*impl_));
    impl_->torn_frames.save(bytes);
    impl_->reconstruction->save(bytes);
    return bytes.take();
  } catch (const SetupError& error) {
    return error.error();
  }
}

Status Pipeline::restore(std::string_view bytes) {
  CHECK(impl_->reconstruction->poses.trajectory().empty(),
        "restore() was called on a pipeline that has seen frames");
  try {
    ByteReader reader(bytes);
    const Status restored = impl_->restore(reader);
    return restored.ok() ? restored : in_context("checkpoint", restored.error());
  } catch (const SetupError& error) {
    return error.error();
  }
}

Status Pipeline::insert(const output::Cloud& cloud) {
  try {
    std::vector<map::Surfel> surfels;
    for (const output::CloudPoint& point : cloud)
      if (point.confidence > 0)
        surfels.push_back(to_surfel(point, impl_->reconstruction->front_end.frame_number + 1));
    impl_->reconstruction->front_end.store.append(surfels);
    impl_->takes_camera_as_it_is = true;
    return Done{};
  } catch (const SetupError& error) {
    return error.error();
  }
}

const dataset::Trajectory& Pipeline::trajectory() const {
  return impl_->reconstruction->poses.trajectory();
}
std::vector<AnchoredPose> Pipeline::anchored_poses() const {
  return impl_->reconstruction->poses.anchored();
}
const ReasonTable& Pipeline::reasons() const { return impl_->reconstruction->reasons; }

Result<output::Cloud> Pipeline::Impl::cloud_of(
    const std::function<bool(const map::Surfel&)>& is_wanted) {
  try {
    output::Cloud cloud;
    for (const auto& [number, surfel, changed_frame] :
         reconstruction->front_end.store.changed_blocks(0))
      if (is_wanted(surfel))
        cloud.push_back(
            to_cloud_point(surfel, reconstruction->layout().world_from_submap[surfel.submap]));
    return cloud;
  } catch (const SetupError& error) {
    return error.error();
  }
}

Result<output::Cloud> Pipeline::cloud() {
  return impl_->cloud_of(
      [this](const map::Surfel& surfel) { return impl_->reconstruction->is_output(surfel); });
}

Result<output::Cloud> Pipeline::surfels() {
  return impl_->cloud_of([this](const map::Surfel& surfel) { return impl_->is_meshed(surfel); });
}

Result<std::vector<output::SlotChange>> Pipeline::take_changes() {
  try {
    const FrontEnd& front_end = impl_->reconstruction->front_end;
    return impl_->changes.take(
        front_end.store, front_end.frame_number,
        [this](const map::Surfel& surfel) { return impl_->is_meshed(surfel); });
  } catch (const SetupError& error) {
    return error.error();
  }
}

void Pipeline::forget_taken_changes() { impl_->changes.forget(); }

std::vector<SubmapPose> Pipeline::submap_poses() const {
  std::vector<SubmapPose> poses;
  for (const Rigid3& pose : impl_->reconstruction->front_end.store.world_from_submap())
    poses.push_back({static_cast<std::uint32_t>(poses.size()), pose,
                     impl_->reconstruction->layout().component[poses.size()]});
  return poses;
}

PipelineStatistics Pipeline::statistics() const {
  PipelineStatistics statistics = statistics_of(*impl_->reconstruction);
  statistics.torn_frame_count = impl_->torn_frames.count();
  statistics.known_camera = impl_->current_preparer()->camera();
  statistics.known_camera.deviations =
      deviations_of(impl_->reconstruction->front_end.certainty().camera_error_rms());
  if (impl_->camera_count > 1) {
    statistics.corrected_camera = impl_->current_preparer()->camera();
    statistics.camera_correction =
        camera_correction_message(impl_->given_camera, *statistics.corrected_camera);
  }
  return statistics;
}

}  // namespace hermite::pipeline
