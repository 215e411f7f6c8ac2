// The container of binary glTF 2.0: a JSON document and a binary buffer.
#pragma once

#include <array>
#include <cstdint>
#include <nlohmann/json.hpp>
#include <string>
#include <string_view>
#include <vector>

#include "core/base/result.h"

namespace hermite::output {

// Constants of the glTF specification.
enum class GltfComponent { kUint16 = 5123, kUint32 = 5125, kFloat = 5126 };
enum class GltfTarget { kNone = 0, kVertices = 34962, kIndices = 34963 };

// An accessor without its data.
struct GltfAccessor {
  GltfComponent component = GltfComponent::kFloat;
  const char* type = "VEC3";  // SCALAR, VEC2, VEC3, VEC4
  std::size_t count = 0;      // number of elements
  bool is_normalized = false;
  std::vector<float> min{}, max{};  // by component; empty: omitted
};

// Builds a GLB from JSON and data. The same calls give the same file. One thread.
class GlbContainer {
 public:
  // The document without accessors, bufferViews and buffers, which finish() adds.
  nlohmann::ordered_json json;

  // These functions return the index of the added object. Views begin at multiples of 4 bytes.
  std::size_t add_view(std::string_view bytes, GltfTarget target = GltfTarget::kNone);
  std::size_t add_accessor(const GltfAccessor& accessor, std::string_view bytes, GltfTarget target);
  // Its data is inside a compressed view.
  std::size_t add_accessor_without_bytes(const GltfAccessor& accessor);

  // Returns kTooLarge when the size exceeds 32 bits.
  Result<std::string> finish();

 private:
  nlohmann::ordered_json accessors_ = nlohmann::ordered_json::array(),
                         views_ = nlohmann::ordered_json::array();
  std::string bytes_;
};

// Returns the memory of a vector's values.
template <class Value>
std::string_view as_bytes(const std::vector<Value>& values) {
  return {reinterpret_cast<const char*>(values.data()), values.size() * sizeof(Value)};
}

}  // namespace hermite::output
