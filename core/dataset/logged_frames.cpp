// Our own frame logs (core/log/frame_log.md): those of the server, and those of `hermite-client
// scan --record`. A log that was cut off by a crash is read up to there.
#include <fmt/core.h>

#include <algorithm>
#include <cmath>
#include <filesystem>
#include <utility>
#include <variant>

#include "core/dataset/byte_file.h"
#include "core/dataset/camera_file.h"
#include "core/dataset/frame_file.h"
#include "core/dataset/recording.h"
#include "core/dataset/remarks.h"
#include "core/log/frame_log_reader.h"
#include "proto/wire/client_message.h"
#include "proto/wire/frame_payload.h"

namespace hermite::dataset {
namespace {

struct LoggedFrame {
  double timestamp_s = 0;
  std::uint32_t segment = 0;
  FilePart message;  // in that segment
};

class LoggedSequence : public Sequence {
 public:
  LoggedSequence(std::string folder, Camera camera, wire::DepthCodec codec, double rate_hz,
                 std::vector<LoggedFrame> frames)
      : folder_(std::move(folder)),
        camera_(std::move(camera)),
        codec_(codec),
        rate_hz_(rate_hz),
        frames_(std::move(frames)) {}

  std::string format() const override { return "frame log"; }
  std::string name() const override {
    return std::filesystem::path(folder_ + "/").parent_path().filename().string();
  }
  const Camera& camera() const override { return camera_; }
  double frame_rate_hz() const override { return rate_hz_; }
  std::int64_t frame_count() const override { return static_cast<std::int64_t>(frames_.size()); }
  double timestamp_s(std::int64_t index) const override {
    return frames_.at(static_cast<std::size_t>(index)).timestamp_s;
  }
  const Trajectory& groundtruth() const override { return none_; }

  Result<RecordedFrame> read(std::int64_t index) const override {
    const LoggedFrame& at = frames_.at(static_cast<std::size_t>(index));
    const Result<ByteFile> segment =
        ByteFile::open(folder_ + "/" + frame_log::segment_name(at.segment));
    if (!segment.ok()) return segment.error();
    const auto bytes = segment->read(at.message);
    if (!bytes.ok()) return in_context(segment->path(), bytes.error());
    Result<wire::Frame> frame = wire::parse_frame_message(
        {reinterpret_cast<const char*>(bytes->data()), bytes->size()}, frame_log::kMaxRecordBytes);
    if (!frame.ok()) return in_context(segment->path(), frame.error());
    auto depth = wire::decode_depth_payload(frame->depth, codec_, camera_);
    if (!depth.ok()) return depth.error();
    return RecordedFrame{at.timestamp_s,
                         *std::move(depth),
                         {frame->color.begin(), frame->color.end()},
                         frame->acceleration_m_s2};
  }

 private:
  const std::string folder_;
  const Camera camera_;
  const wire::DepthCodec codec_;
  const double rate_hz_;
  const std::vector<LoggedFrame> frames_;
  const Trajectory none_;
};

// The result of one pass over the log. All frames of a log use the codec that its start offers
// first.
struct LogIndex {
  wire::StartScan start;
  std::vector<LoggedFrame> frames;
  bool finished = false;
  std::string cut;
  Remarks out_of_order{"frames have no time after the one before and are left out:"};
};

Status add_start(const std::string& payload, LogIndex& index) {
  Result<wire::ClientMessage> message =
      wire::parse_client_message(payload, wire::kMaxBytesBeforeWelcome);
  if (!message.ok()) return message.error();
  wire::Hello* const hello = std::get_if<wire::Hello>(&*message);
  if (!hello || !std::holds_alternative<wire::StartScan>(hello->role))
    return Error{ErrorCode::kCorruptData, "the start is no hello of a camera"};
  index.start = std::get<wire::StartScan>(std::move(hello->role));
  return Done{};
}

Status add_frame(const frame_log::LogRecord& record, const frame_log::LogEnd& end,
                 LogIndex& index) {
  const Result<wire::Frame> frame =
      wire::parse_frame_message(record.payload, frame_log::kMaxRecordBytes);
  if (!frame.ok()) return frame.error();
  if (!std::isfinite(frame->timestamp_s) ||
      (!index.frames.empty() && frame->timestamp_s <= index.frames.back().timestamp_s)) {
    index.out_of_order.add("record " + std::to_string(record.number));
    return Done{};
  }
  if (static_cast<std::int64_t>(index.frames.size()) >= kMaxFileFrames)
    return Error{ErrorCode::kTooLarge, fmt::format("more than {} frames", kMaxFileFrames)};
  index.frames.push_back({frame->timestamp_s,
                          end.segment,
                          {end.offset - record.payload.size(), record.payload.size()}});
  return Done{};
}

Result<LogIndex> read_index(const std::string& folder) {
  frame_log::FrameLogReader reader(folder);
  LogIndex index;
  for (;;) {
    const Result<std::optional<frame_log::LogRecord>> record = reader.next();
    if (!record.ok()) return record.error();
    if (!*record) break;
    Status status = Done{};
    if (((*record)->type == frame_log::RecordType::kStart) != ((*record)->number == 1))
      return Error{ErrorCode::kCorruptData,
                   folder + ": the log does not begin with terms and start"};
    if ((*record)->type == frame_log::RecordType::kStart)
      status = add_start((*record)->payload, index);
    if ((*record)->type == frame_log::RecordType::kFrame)
      status = add_frame(**record, reader.end(), index);
    if ((*record)->type == frame_log::RecordType::kFinish) index.finished = true;
    if (!status.ok())
      return in_context(fmt::format("{}, record {}", folder, (*record)->number), status.error());
  }
  index.cut = reader.end().message;
  if (index.frames.empty())
    return Error{ErrorCode::kCorruptData, fmt::format("{}: the log has no frame{}", folder,
                                                      index.cut.empty() ? "" : ": " + index.cut)};
  return index;
}

// Returns the rate from the median step, because a log does not contain the nominal rate.
double rate_of(const std::vector<LoggedFrame>& frames) {
  std::vector<double> steps_s;
  for (std::size_t i = 1; i < frames.size(); ++i)
    steps_s.push_back(frames[i].timestamp_s - frames[i - 1].timestamp_s);
  if (steps_s.empty()) return kDefaultFrameRate_hz;
  const auto middle = steps_s.begin() + static_cast<std::ptrdiff_t>(steps_s.size() / 2);
  std::nth_element(steps_s.begin(), middle, steps_s.end());
  return 1 / *middle;
}

}  // namespace

std::optional<std::string> probe_frame_log(const std::string& path) {
  const Result<ByteFile> file = ByteFile::open(path + "/" + frame_log::segment_name(0));
  std::string header(frame_log::kSegmentHeaderBytes, '\0');
  if (!file.ok() || !file->read_into(0, header.data(), header.size()).ok() ||
      header != frame_log::format_segment_header(0))
    return std::nullopt;
  return frame_log::segment_name(0) + " begins with HRMFLOG1 (our frame log)";
}

Result<Recording> open_frame_log(const std::string& path, const std::optional<Camera>& given) {
  Result<LogIndex> index = read_index(path);
  if (!index.ok()) return index.error();
  const Camera& own = index->start.camera;
  if (given && (given->width != own.width || given->height != own.height))
    return Error{ErrorCode::kInvalidArgument,
                 fmt::format("{}: its images have {}x{} pixels, the camera {}x{}", path, own.width,
                             own.height, given->width, given->height)};
  Recording recording;
  recording.camera_source = given ? "given" : "the log";
  if (!index->cut.empty())
    recording.doubts.push_back("the log is cut, what is behind cannot be used: " + index->cut);
  if (!index->finished)
    recording.doubts.push_back("the log was not finished: the scan was broken off, or still runs");
  for (const std::string& line : index->out_of_order.lines()) recording.doubts.push_back(line);
  const double rate_hz = rate_of(index->frames);
  recording.sequence =
      std::make_unique<LoggedSequence>(path, given.value_or(own), index->start.depth_codecs.front(),
                                       rate_hz, std::move(index->frames));
  return recording;
}

}  // namespace hermite::dataset
