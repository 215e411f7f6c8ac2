// What a camera gives, on this machine's disk: a frame log (core/log/frame_log.md) like the server's, which is streamed from while it
// grows. So nothing is lost while the server is away, and memory stays bounded however long that is.
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

namespace hermite {

// Encodes on a thread of its own. Const functions and offer() from any thread.
class LocalLog {
 public:
  // In a new folder. kInvalidArgument: it is there already. kIo.
  static Result<std::unique_ptr<LocalLog>> create(const std::string& folder, const std::string& title, const Camera& camera,
                                                  wire::DepthCodec depth_codec);
  ~LocalLog();  // finishes
  LocalLog(const LocalLog&) = delete;
  LocalLog& operator=(const LocalLog&) = delete;

  // Never waits. Dropped, and counted, when kMaxWaiting frames wait to be encoded; not taken after finish() or a failure.
  void offer(RgbdFrame frame);
  static constexpr std::size_t kMaxWaiting = 8;

  // Blocks until all that was offered is durable.
  void finish();

  struct State {
    std::uint64_t durable_count = 0;  // frames that are on the disk
    std::uint64_t dropped_count = 0;
    std::uint64_t bytes = 0;         // of the frames so far
    bool ended = false;              // the durable ones are all there will be
    std::optional<Error> failure{};  // of the disk; what was durable before stays
  };
  State state() const;
  State wait_for(std::uint64_t durable_count, std::chrono::milliseconds patience) const;  // or for the end

  const std::string& folder() const;
  const Camera& camera() const;
  wire::DepthCodec depth_codec() const;

 private:
  struct Impl;
  explicit LocalLog(std::unique_ptr<Impl> impl);
  std::unique_ptr<Impl> impl_;
};

// The frames of a local log from its beginning, as far as they are durable, up to its end or to where the disk does not give back what it
// has taken. `log` must outlive this.
class LocalLogFrames final : public FrameSource {
 public:
  explicit LocalLogFrames(const LocalLog& log);
  const Camera& camera() const override { return log_.camera(); }
  std::uint64_t expected_frames() const override { return 0; }
  std::vector<wire::DepthCodec> depth_codecs() const override;  // the log's own goes out as it is
  Supply next(const WireEncoding& encoding, EncodedFrame& frame) override;

  const std::optional<Error>& failure() const { return failure_; }  // when nobody calls next() any more

 private:
  Result<EncodedFrame> read(const WireEncoding& encoding);

  const LocalLog& log_;
  FrameLogReader reader_;
  std::uint64_t next_ = 0;
  std::optional<Error> failure_;
};

}  // namespace hermite
