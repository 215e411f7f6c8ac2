// What decoders of depth say of bytes that cannot be what they claim to be. Header only.
#pragma once

#include <string>

#include "core/base/result.h"

namespace hermite::image {

inline Error corrupt_depth(const std::string& message) {
  return {ErrorCode::kCorruptData, "depth: " + message};
}

}  // namespace hermite::image
