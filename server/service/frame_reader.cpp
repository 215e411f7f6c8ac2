#include "server/service/frame_reader.h"

#include <condition_variable>
#include <deque>
#include <mutex>
#include <thread>
#include <utility>

#include "proto/wire/frame_payload.h"

namespace hermite {

namespace {

ReadFrame read_frame(const Sequence& sequence, std::int64_t index) {
  const Camera& camera = sequence.camera();
  Result<RecordedFrame> recorded = sequence.read(index);
  Result<RgbdFrame> frame = recorded.ok() ? decode_frame(*std::move(recorded)) : Result<RgbdFrame>(recorded.error());
  if (frame.ok()) return {index, *std::move(frame), ""};
  return {index, wire::empty_frame(sequence.timestamp_s(index), camera), frame.error().message};
}

}  // namespace

struct FrameReader::Impl {
  const Sequence& sequence;
  const FrameRange range;
  const std::size_t ahead;
  std::mutex mutex;
  std::condition_variable changed;
  std::deque<ReadFrame> frames;  // guarded by mutex, as all below
  std::int64_t taken = 0;
  bool stop = false;
  std::thread thread;

  Impl(const Sequence& source, FrameRange frame_range, std::size_t frames_ahead)
      : sequence(source), range(frame_range), ahead(frames_ahead) {}

  void read_all() {
    for (std::int64_t index = range.begin; index < range.end; ++index) {
      {
        std::unique_lock lock(mutex);
        changed.wait(lock, [this] { return stop || frames.size() < ahead; });
        if (stop) return;
      }
      ReadFrame frame = read_frame(sequence, index);
      const std::lock_guard lock(mutex);
      frames.push_back(std::move(frame));
      changed.notify_all();
    }
  }
};

FrameReader::FrameReader(const Sequence& sequence, FrameRange range, std::size_t ahead)
    : impl_(std::make_unique<Impl>(sequence, range, ahead)) {
  impl_->thread = std::thread([impl = impl_.get()] { impl->read_all(); });
}

FrameReader::~FrameReader() {
  {
    const std::lock_guard lock(impl_->mutex);
    impl_->stop = true;
  }
  impl_->changed.notify_all();
  impl_->thread.join();
}

std::optional<ReadFrame> FrameReader::next() {
  std::unique_lock lock(impl_->mutex);
  if (impl_->taken == impl_->range.count()) return std::nullopt;
  impl_->changed.wait(lock, [this] { return !impl_->frames.empty(); });
  ReadFrame frame = std::move(impl_->frames.front());
  impl_->frames.pop_front();
  ++impl_->taken;
  impl_->changed.notify_all();
  return frame;
}

}  // namespace hermite
