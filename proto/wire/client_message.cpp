#include "proto/wire/client_message.h"

#include <fmt/core.h>
#include <google/protobuf/io/coded_stream.h>
#include <google/protobuf/wire_format_lite.h>

#include <cstdint>
#include <utility>

#include "proto/wire/fields.h"

namespace hermite::wire {

namespace {

// Codecs of a newer client are skipped, so that it may offer them without asking first.
template <class Codec>
Result<std::vector<Codec>> known_codecs(const std::string& field,
                                        const google::protobuf::RepeatedField<int>& offered,
                                        std::optional<Codec> (*known_codec)(int),
                                        const char* names) {
  if (offered.size() > kMaxCodecs)
    return Error{ErrorCode::kTooLarge, fmt::format("{} has {} entries, allowed are {}", field,
                                                   offered.size(), kMaxCodecs)};
  std::vector<Codec> known;
  for (const int number : offered)
    if (const auto codec = known_codec(number)) known.push_back(*codec);
  if (known.empty())
    return Error{ErrorCode::kUnsupported,
                 fmt::format("{} offers none of those this server knows: {}", field, names)};
  return known;
}

Status check_settings(const google::protobuf::Map<std::string, std::string>& settings) {
  if (settings.size() > static_cast<std::size_t>(kMaxSettings))
    return Error{ErrorCode::kTooLarge,
                 fmt::format("start_scan.settings has {} entries, allowed are {}", settings.size(),
                             kMaxSettings)};
  for (const auto& [key, value] : settings) {
    if (Status status = check_text("a key of start_scan.settings", key, kMaxSettingBytes);
        !status.ok())
      return status;
    if (Status status =
            check_text(fmt::format("start_scan.settings[{}]", key), value, kMaxSettingBytes);
        !status.ok())
      return status;
  }
  return Done{};
}

Result<StartScan> start_scan_from(const v1::StartScan& message) {
  StartScan start;
  if (Status status = check_text("start_scan.title", message.title(), kMaxTitleBytes); !status.ok())
    return status.error();
  start.title = message.title();
  start.camera = camera_from(message.camera());
  if (Status status = validate(start.camera); !status.ok())
    return in_context("start_scan", status.error());
  auto depth = known_codecs<DepthCodec>("start_scan.depth_codecs", message.depth_codecs(),
                                        depth_codec_from, "RVL_ZSTD, PNG16, RANKS");
  if (!depth.ok()) return depth.error();
  start.depth_codecs = *std::move(depth);
  auto color = known_codecs<ColorCodec>("start_scan.color_codecs", message.color_codecs(),
                                        color_codec_from, "JPEG, PNG");
  if (!color.ok()) return color.error();
  start.color_codecs = *std::move(color);
  if (message.mode() != v1::MODE_BATCH && message.mode() != v1::MODE_LIVE)
    return Error{ErrorCode::kInvalidArgument,
                 fmt::format("start_scan.mode is {}, allowed are 1 (batch) and 2 (live)",
                             static_cast<int>(message.mode()))};
  start.mode = static_cast<Mode>(message.mode());
  if (Status status = check_settings(message.settings()); !status.ok()) return status.error();
  start.settings.insert(message.settings().begin(), message.settings().end());
  start.expected_frames = message.expected_frames();
  start.frame_patience_s = message.frame_patience_s();
  return start;
}

Watch watch_from(const v1::Watch& message) { return {message.points(), message.mesh()}; }

Result<ClientMessage> hello_from(v1::Hello& message) {
  Hello hello;
  hello.protocol_minor = message.protocol_minor();
  if (Status status = check_text("hello.client", message.client(), kMaxClientNameBytes);
      !status.ok())
    return status.error();
  if (Status status = check_text("hello.token", message.token(), kMaxTokenBytes); !status.ok())
    return status.error();
  hello.client = std::move(*message.mutable_client());
  hello.token = std::move(*message.mutable_token());
  switch (message.role_case()) {
    case v1::Hello::kStartScan: {
      Result<StartScan> start = start_scan_from(message.start_scan());
      if (!start.ok()) return start.error();
      hello.role = *std::move(start);
      return ClientMessage(std::move(hello));
    }
    case v1::Hello::kViewScan: {
      if (Status status =
              check_text("view_scan.scan_id", message.view_scan().scan_id(), kMaxScanIdBytes);
          !status.ok())
        return status.error();
      hello.role = ViewScan{
          message.view_scan().scan_id(),
          message.view_scan().has_watch() ? watch_from(message.view_scan().watch()) : Watch{}};
      return ClientMessage(std::move(hello));
    }
    case v1::Hello::kResumeScan: {
      v1::ResumeScan& resume = *message.mutable_resume_scan();
      if (Status status = check_text("resume_scan.scan_id", resume.scan_id(), kMaxScanIdBytes);
          !status.ok())
        return status.error();
      if (Status status =
              check_text("resume_scan.resume_token", resume.resume_token(), kMaxTokenBytes);
          !status.ok())
        return status.error();
      hello.role = ResumeScan{std::move(*resume.mutable_scan_id()),
                              std::move(*resume.mutable_resume_token()), resume.next_sequence()};
      return ClientMessage(std::move(hello));
    }
    case v1::Hello::ROLE_NOT_SET: break;
  }
  return Error{
      ErrorCode::kUnsupported,
      "hello.role is missing or unknown; allowed are start_scan, view_scan and resume_scan"};
}

void write_start_scan(const StartScan& start, v1::StartScan& message) {
  message.set_title(start.title);
  write_camera(start.camera, *message.mutable_camera());
  for (const DepthCodec codec : start.depth_codecs)
    message.add_depth_codecs(static_cast<v1::DepthCodec>(codec));
  for (const ColorCodec codec : start.color_codecs)
    message.add_color_codecs(static_cast<v1::ColorCodec>(codec));
  message.set_mode(static_cast<v1::Mode>(start.mode));
  message.mutable_settings()->insert(start.settings.begin(), start.settings.end());
  message.set_expected_frames(start.expected_frames);
  message.set_frame_patience_s(start.frame_patience_s);
}

void write_watch(const Watch& watch, v1::Watch& message) {
  message.set_points(watch.points);
  message.set_mesh(watch.mesh);
}

// One overload a body: a new one does not compile until it is written here.
struct Writer {
  v1::ClientMessage& message;

  void operator()(Unknown&) const {}
  void operator()(Hello& hello) const {
    v1::Hello& out = *message.mutable_hello();
    out.set_protocol_minor(hello.protocol_minor);
    out.set_client(std::move(hello.client));
    out.set_token(std::move(hello.token));
    if (const StartScan* start = std::get_if<StartScan>(&hello.role))
      write_start_scan(*start, *out.mutable_start_scan());
    if (const ViewScan* view = std::get_if<ViewScan>(&hello.role)) {
      out.mutable_view_scan()->set_scan_id(view->scan_id);
      write_watch(view->watch, *out.mutable_view_scan()->mutable_watch());
    }
    if (ResumeScan* resume = std::get_if<ResumeScan>(&hello.role)) {
      out.mutable_resume_scan()->set_scan_id(std::move(resume->scan_id));
      out.mutable_resume_scan()->set_resume_token(std::move(resume->resume_token));
      out.mutable_resume_scan()->set_next_sequence(resume->next_sequence);
    }
  }
  void operator()(Frame& frame) const {
    v1::Frame& out = *message.mutable_frame();
    out.set_sequence(frame.sequence);
    out.set_timestamp_s(frame.timestamp_s);
    out.set_depth(std::move(frame.depth));
    out.set_color(std::move(frame.color));
    if (frame.acceleration_m_s2)
      write_vector3(*frame.acceleration_m_s2, *out.mutable_acceleration_m_s2());
  }
  void operator()(Finish&) const { message.mutable_finish(); }
  void operator()(ViewerAck& ack) const { message.mutable_viewer_ack()->set_bytes(ack.bytes); }
  void operator()(Ping& ping) const { message.mutable_ping()->set_id(ping.id); }
  void operator()(Pause&) const { message.mutable_pause(); }
  void operator()(Unpause&) const { message.mutable_unpause(); }
  void operator()(Discard&) const { message.mutable_discard(); }
  void operator()(Watch& watch) const { write_watch(watch, *message.mutable_watch()); }
};

}  // namespace

Result<ClientMessage> parse_client_message(std::string_view bytes, std::size_t max_bytes) {
  v1::ClientMessage message;
  if (Status status = parse_bytes(bytes, max_bytes, message); !status.ok()) return status.error();
  switch (message.body_case()) {
    case v1::ClientMessage::kHello: return hello_from(*message.mutable_hello());
    case v1::ClientMessage::kFrame: {
      v1::Frame& frame = *message.mutable_frame();
      std::optional<Eigen::Vector3d> acceleration_m_s2;
      if (frame.has_acceleration_m_s2())
        acceleration_m_s2 = vector3_from(frame.acceleration_m_s2());
      return ClientMessage(Frame{frame.sequence(), frame.timestamp_s(),
                                 std::move(*frame.mutable_depth()),
                                 std::move(*frame.mutable_color()), acceleration_m_s2});
    }
    case v1::ClientMessage::kFinish: return ClientMessage(Finish{});
    case v1::ClientMessage::kViewerAck:
      return ClientMessage(ViewerAck{message.viewer_ack().bytes()});
    case v1::ClientMessage::kPing: return ClientMessage(Ping{message.ping().id()});
    case v1::ClientMessage::kPause: return ClientMessage(Pause{});
    case v1::ClientMessage::kUnpause: return ClientMessage(Unpause{});
    case v1::ClientMessage::kDiscard: return ClientMessage(Discard{});
    case v1::ClientMessage::kWatch: return ClientMessage(watch_from(message.watch()));
    case v1::ClientMessage::BODY_NOT_SET: break;
  }
  return ClientMessage(Unknown{});
}

Result<Frame> parse_frame_message(std::string_view bytes, std::size_t max_bytes) {
  Result<ClientMessage> message = parse_client_message(bytes, max_bytes);
  if (!message.ok()) return message.error();
  Frame* const frame = std::get_if<Frame>(&*message);
  if (!frame) return Error{ErrorCode::kCorruptData, "it is another message than a frame"};
  return std::move(*frame);
}

std::optional<double> frame_time_in(std::string_view beginning) {
  using google::protobuf::internal::WireFormatLite;
  google::protobuf::io::CodedInputStream stream(
      reinterpret_cast<const std::uint8_t*>(beginning.data()), static_cast<int>(beginning.size()));
  constexpr auto kBody = WireFormatLite::MakeTag(v1::ClientMessage::kFrameFieldNumber,
                                                 WireFormatLite::WIRETYPE_LENGTH_DELIMITED);
  constexpr auto kSequence =
      WireFormatLite::MakeTag(v1::Frame::kSequenceFieldNumber, WireFormatLite::WIRETYPE_VARINT);
  constexpr auto kTime =
      WireFormatLite::MakeTag(v1::Frame::kTimestampSFieldNumber, WireFormatLite::WIRETYPE_FIXED64);
  std::uint32_t body_bytes = 0;
  std::uint64_t sequence = 0, bits = 0;
  if (stream.ReadTag() != kBody || !stream.ReadVarint32(&body_bytes)) return std::nullopt;
  std::uint32_t tag = stream.ReadTag();
  if (tag == kSequence) {
    if (!stream.ReadVarint64(&sequence)) return std::nullopt;
    tag = stream.ReadTag();
  }
  if (tag != kTime || !stream.ReadLittleEndian64(&bits)) return std::nullopt;
  return WireFormatLite::DecodeDouble(bits);
}

std::string format_client_message(ClientMessage message) {
  v1::ClientMessage out;
  std::visit(Writer{out}, message);
  return out.SerializeAsString();
}

}  // namespace hermite::wire
