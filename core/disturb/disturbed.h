// Makes the decorator of a disturbance once its options are read. Header only.
#pragma once

#include <memory>
#include <utility>

#include "core/dataset/sequence.h"

namespace hermite::disturb {

// Returns `sequence` in a Disturbed with these options; the error of `status`, beginning with
// `name`, if it is one.
template <class Disturbed, class... Options>
Result<std::unique_ptr<dataset::Sequence>> when_ok(const Status& status, const char* name,
                                                   std::unique_ptr<dataset::Sequence> sequence,
                                                   const Options&... options) {
  if (!status.ok()) return in_context(name, status.error());
  return std::unique_ptr<dataset::Sequence>(
      std::make_unique<Disturbed>(std::move(sequence), options...));
}

}  // namespace hermite::disturb
