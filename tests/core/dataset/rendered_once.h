// A synthetic sequence whose frames are rendered when they are read first: large ones that a test reads again and again. Header only.
#pragma once

#include <map>
#include <memory>
#include <string>
#include <utility>

#include "core/dataset/sequence.h"

namespace hermite::test {

class RenderedOnce : public Sequence {
 public:
  explicit RenderedOnce(const std::string& source) : source_(*open_sequence(source)) {}

  std::string format() const override { return source_->format(); }
  std::string name() const override { return source_->name(); }
  const Camera& camera() const override { return source_->camera(); }
  double frame_rate_hz() const override { return source_->frame_rate_hz(); }
  std::int64_t frame_count() const override { return source_->frame_count(); }
  double timestamp_s(std::int64_t index) const override { return source_->timestamp_s(index); }
  const Trajectory& groundtruth() const override { return source_->groundtruth(); }

  Result<RecordedFrame> read(std::int64_t index) const override {
    auto found = frames_.find(index);
    if (found == frames_.end()) found = frames_.emplace(index, source_->read(index)).first;
    return found->second;
  }

 private:
  const std::unique_ptr<Sequence> source_;
  mutable std::map<std::int64_t, Result<RecordedFrame>> frames_;
};

}  // namespace hermite::test
