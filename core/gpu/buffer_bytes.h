// Saves the content of a buffer in the format of core/base/byte_stream.h. Between submissions.
#pragma once

#include <vector>

#include "core/base/byte_stream.h"
#include "core/gpu/buffer.h"

namespace hermite::gpu {

template <class T>
void save(ByteWriter& bytes, const Buffer<T>& buffer) {
  bytes.numbers(buffer.download());
}

// The reader fails if the saved content has another length than the buffer, which then keeps its
// content.
template <class T>
void restore(ByteReader& bytes, Buffer<T>& buffer) {
  std::vector<T> values;
  bytes.numbers(values);
  bytes.require(values.size() == buffer.count(), "a buffer of another length");
  if (bytes.ok()) buffer.upload(values);
}

}  // namespace hermite::gpu
