// A synthetic sequence whose frames are rendered when they are read first: large ones that a test
// reads again and again. Header only.
#pragma once

#include <map>
#include <string>

#include "core/dataset/changed_sequence.h"
#include "core/source/open_sequence.h"

namespace hermite::test {

class RenderedOnce : public dataset::ChangedSequence {
 public:
  explicit RenderedOnce(const std::string& source)
      : dataset::ChangedSequence(*source::open_sequence(source)) {}

  Result<dataset::RecordedFrame> read(std::int64_t index) const override {
    auto found = frames_.find(index);
    if (found == frames_.end()) found = frames_.emplace(index, original_->read(index)).first;
    return found->second;
  }

 private:
  mutable std::map<std::int64_t, Result<dataset::RecordedFrame>> frames_;
};

}  // namespace hermite::test
