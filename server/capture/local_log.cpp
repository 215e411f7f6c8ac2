#include "server/capture/local_log.h"

#include <condition_variable>
#include <deque>
#include <filesystem>
#include <mutex>
#include <thread>
#include <utility>

#include "core/log/frame_log.h"
#include "proto/wire/client_message.h"
#include "proto/wire/frame_payload.h"
#include "server/capture/live_frames.h"
#include "server/client/frame_encoder.h"

namespace hermite::client {
namespace {

// A local log has no settings of a server.
constexpr const char* kTerms = "{}";

}  // namespace

struct LocalLog::Impl {
  const std::string folder;
  const Camera camera;
  const wire::DepthCodec codec;

  mutable std::mutex mutex;
  mutable std::condition_variable changed;
  std::deque<frame::RgbdFrame> waiting;  // guarded by mutex, as the next two
  bool closing = false;
  State state;

  std::unique_ptr<frame_log::FrameLog> log;  // used only by the encoding thread once that runs
  std::uint64_t frame_count = 0;             // the same
  std::thread thread;

  Impl(std::string log_folder, const Camera& log_camera, wire::DepthCodec log_codec)
      : folder(std::move(log_folder)), camera(log_camera), codec(log_codec) {}

  frame_log::FrameLogEvents events() {
    return {
        .durable = [this](std::uint64_t count) { change([&] { state.durable_count = count; }); },
        .failed = [this](const Error& error) { fail(error); }};
  }

  template <class Change>
  void change(Change what) {
    {
      const std::lock_guard lock(mutex);
      what();
    }
    changed.notify_all();
  }

  void fail(const Error& error) {
    change([&] {
      if (!state.failure) state.failure = error;
      waiting.clear();
    });
  }

  std::optional<frame::RgbdFrame> take() {
    std::unique_lock lock(mutex);
    changed.wait(lock, [this] { return closing || state.failure || !waiting.empty(); });
    if (waiting.empty() || state.failure) return std::nullopt;
    frame::RgbdFrame frame = std::move(waiting.front());
    waiting.pop_front();
    return frame;
  }

  void run() {
    while (std::optional<frame::RgbdFrame> captured = take()) {
      wire::Frame frame = encode_captured(*captured, codec, kJpegQuality);
      frame.sequence = frame_count;
      std::string message = wire::format_client_message(std::move(frame));
      const std::size_t bytes = message.size();
      const Status status = log->append(frame_log::RecordType::kFrame, std::move(message));
      if (status.ok()) {
        ++frame_count;
        change([&] { state.bytes += bytes; });
      } else if (status.error().code == ErrorCode::kBusy) {
        change([&] { ++state.dropped_count; });
      } else {
        fail(status.error());
      }
    }
    // After a failure it is refused, which was reported already.
    static_cast<void>(log->append(frame_log::RecordType::kFinish, {}));
    // Writes what is pending, and reports it.
    log.reset();
    change([&] { state.ended = true; });
  }
};

LocalLog::LocalLog(std::unique_ptr<Impl> impl) : impl_(std::move(impl)) {
  impl_->thread = std::thread([running = impl_.get()] { running->run(); });
}

LocalLog::~LocalLog() { finish(); }

Result<std::unique_ptr<LocalLog>> LocalLog::create(const std::string& folder,
                                                   const std::string& title, const Camera& camera,
                                                   wire::DepthCodec depth_codec) {
  if (std::error_code ignored; std::filesystem::exists(folder, ignored))
    return Error{ErrorCode::kInvalidArgument,
                 folder + " is there already: a recording needs a new folder"};
  auto impl = std::make_unique<Impl>(folder, camera, depth_codec);
  wire::StartScan start;
  start.title = title;
  start.camera = camera;
  start.depth_codecs = {depth_codec};
  start.color_codecs = {wire::ColorCodec::kJpeg};
  const std::string hello = wire::format_client_message(
      wire::Hello{wire::kProtocolMinor, "hermite-client", "", std::move(start)});
  auto log = frame_log::FrameLog::create(folder, kTerms, hello, impl->events());
  if (!log.ok()) return log.error();
  impl->log = *std::move(log);
  return std::unique_ptr<LocalLog>(new LocalLog(std::move(impl)));
}

void LocalLog::offer(frame::RgbdFrame frame) {
  impl_->change([&] {
    if (impl_->closing || impl_->state.failure) return;
    if (impl_->waiting.size() < kMaxWaiting)
      impl_->waiting.push_back(std::move(frame));
    else
      ++impl_->state.dropped_count;
  });
}

void LocalLog::finish() {
  impl_->change([&] { impl_->closing = true; });
  if (impl_->thread.joinable()) impl_->thread.join();
}

LocalLog::State LocalLog::state() const {
  const std::lock_guard lock(impl_->mutex);
  return impl_->state;
}

LocalLog::State LocalLog::wait_for(std::uint64_t durable_count,
                                   std::chrono::milliseconds patience) const {
  std::unique_lock lock(impl_->mutex);
  impl_->changed.wait_for(lock, patience, [&] {
    return impl_->state.ended || impl_->state.durable_count >= durable_count;
  });
  return impl_->state;
}

const std::string& LocalLog::folder() const { return impl_->folder; }
const Camera& LocalLog::camera() const { return impl_->camera; }
wire::DepthCodec LocalLog::depth_codec() const { return impl_->codec; }

LocalLogFrames::LocalLogFrames(const LocalLog& log) : log_(log), reader_(log.folder()) {}

std::vector<wire::DepthCodec> LocalLogFrames::depth_codecs() const {
  std::vector<wire::DepthCodec> codecs{log_.depth_codec()};
  for (const wire::DepthCodec codec : wire::kDepthCodecs)
    if (codec != log_.depth_codec()) codecs.push_back(codec);
  return codecs;
}

Supply LocalLogFrames::next(const WireEncoding& encoding, EncodedFrame& frame) {
  if (failure_) return Supply::kEnd;
  const LocalLog::State state = log_.wait_for(next_ + 1, kSupplyPatience);
  if (state.durable_count <= next_) return state.ended ? Supply::kEnd : Supply::kNotYet;
  Result<EncodedFrame> found = read(encoding);
  if (!found.ok()) {
    failure_ = in_context("the local log cannot be read back", found.error());
    return Supply::kEnd;
  }
  frame = *std::move(found);
  ++next_;
  return Supply::kFrame;
}

Result<EncodedFrame> LocalLogFrames::read(const WireEncoding& encoding) {
  Result<std::optional<frame_log::LogRecord>> record = reader_.next();
  while (record.ok() && *record && (*record)->type != frame_log::RecordType::kFrame)
    record = reader_.next();
  if (!record.ok()) return record.error();
  if (!*record)
    return Error{ErrorCode::kCorruptData, "the log has become shorter: " + reader_.end().message};
  Result<wire::Frame> logged =
      wire::parse_frame_message((*record)->payload, frame_log::kMaxRecordBytes);
  if (!logged.ok()) return logged.error();
  EncodedFrame frame{
      .index = static_cast<std::int64_t>(next_), .frame = *std::move(logged), .problem = {}};
  if (encoding.depth == log_.depth_codec()) return frame;
  // An older server does not know the codec of the log.
  auto depth = wire::decode_depth_payload(frame.frame.depth, log_.depth_codec(), log_.camera());
  if (!depth.ok()) return depth.error();
  auto payload = wire::encode_depth_payload(*depth, encoding.depth);
  if (!payload.ok()) return payload.error();
  frame.frame.depth = *std::move(payload);
  return frame;
}

}  // namespace hermite::client
