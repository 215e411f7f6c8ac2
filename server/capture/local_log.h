// Records the frames of a camera on this machine's disk in a frame log (core/log/frame_log.md) like
// the server's, from which they are streamed while it grows. So nothing is lost while the server is
// unreachable, and memory stays bounded however long that takes.
#pragma once

#include <chrono>
#include <cstdint>
#include <memory>
#include <optional>
#include <string>
#include <vector>

#include "core/base/result.h"
#include "core/frame/rgbd_frame.h"
#include "core/log/frame_log_reader.h"
#include "server/client/frame_source.h"

namespace hermite::client {

// Encodes on its own thread. Const functions and offer() may be called from any thread.
class LocalLog {
 public:
  // Creates the log in a new folder. kInvalidArgument: the folder exists already. kIo.
  static Result<std::unique_ptr<LocalLog>> create(const std::string& folder,
                                                  const std::string& title, const Camera& camera,
                                                  wire::DepthCodec depth_codec);
  ~LocalLog();  // calls finish()
  LocalLog(const LocalLog&) = delete;
  LocalLog& operator=(const LocalLog&) = delete;

  // Never waits. If kMaxWaiting frames wait to be encoded already, the frame is dropped and
  // counted; after finish() or a failure it is ignored.
  void offer(frame::RgbdFrame frame);
  static constexpr std::size_t kMaxWaiting = 8;

  // Blocks until all offered frames are durable.
  void finish();

  struct State {
    std::uint64_t durable_count = 0;  // frames on disk
    std::uint64_t dropped_count = 0;
    std::uint64_t bytes = 0;         // of all frames so far
    bool ended = false;              // there will be no more durable frames
    std::optional<Error> failure{};  // of the disk; frames that were durable before remain
  };
  State state() const;
  // Waits for so many durable frames, or for the end.
  State wait_for(std::uint64_t durable_count, std::chrono::milliseconds patience) const;

  const std::string& folder() const;
  const Camera& camera() const;
  wire::DepthCodec depth_codec() const;

 private:
  struct Impl;
  explicit LocalLog(std::unique_ptr<Impl> impl);
  std::unique_ptr<Impl> impl_;
};

// Reads the frames of a local log from its beginning as they become durable, up to its end or until
// the disk fails to read what it has stored. `log` must outlive this.
class LocalLogFrames final : public FrameSource {
 public:
  explicit LocalLogFrames(const LocalLog& log);
  const Camera& camera() const override { return log_.camera(); }
  std::uint64_t expected_frames() const override { return 0; }
  // The codec of the log first, in which frames are sent as they are.
  std::vector<wire::DepthCodec> depth_codecs() const override;
  Supply next(const WireEncoding& encoding, EncodedFrame& frame) override;

  // Call it only once next() is not called any more.
  const std::optional<Error>& failure() const { return failure_; }

 private:
  Result<EncodedFrame> read(const WireEncoding& encoding);

  const LocalLog& log_;
  frame_log::FrameLogReader reader_;
  std::uint64_t next_ = 0;
  std::optional<Error> failure_;
};

}  // namespace hermite::client
