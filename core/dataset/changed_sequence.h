// A sequence derived from another one: everything that a derived class does not override is taken
// from the original. Header only.
#pragma once

#include <memory>
#include <string>
#include <utility>

#include "core/dataset/sequence.h"

namespace hermite::dataset {

class ChangedSequence : public Sequence {
 public:
  explicit ChangedSequence(std::unique_ptr<Sequence> original) : original_(std::move(original)) {}

  std::string format() const override { return original_->format(); }
  std::string name() const override { return original_->name(); }
  const Camera& camera() const override { return original_->camera(); }
  double frame_rate_hz() const override { return original_->frame_rate_hz(); }
  std::int64_t frame_count() const override { return original_->frame_count(); }
  double timestamp_s(std::int64_t index) const override { return original_->timestamp_s(index); }
  Result<RecordedFrame> read(std::int64_t index) const override { return original_->read(index); }
  const Trajectory& groundtruth() const override { return original_->groundtruth(); }

 protected:
  const std::unique_ptr<Sequence> original_;
};

// The same frames with another camera of the same size.
class RecalibratedSequence : public ChangedSequence {
 public:
  RecalibratedSequence(std::unique_ptr<Sequence> original, const Camera& camera)
      : ChangedSequence(std::move(original)), camera_(camera) {}
  const Camera& camera() const override { return camera_; }

 private:
  const Camera camera_;
};

}  // namespace hermite::dataset
