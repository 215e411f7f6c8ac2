// The container of binary glTF 2.0: one JSON and the bytes that it names.
#pragma once

#include <array>
#include <cstdint>
#include <nlohmann/json.hpp>
#include <string>
#include <string_view>
#include <vector>

#include "core/base/result.h"

namespace hermite {

// Numbers of the specification.
enum class GltfComponent { kUint16 = 5123, kUint32 = 5125, kFloat = 5126 };
enum class GltfTarget { kNone = 0, kVertices = 34962, kIndices = 34963 };

// What an accessor is, but for its bytes.
struct GltfAccessor {
  GltfComponent component = GltfComponent::kFloat;
  const char* type = "VEC3";  // SCALAR, VEC2, VEC3, VEC4
  std::size_t count = 0;      // of elements
  bool is_normalized = false;
  std::vector<float> min{}, max{};  // by component; empty: not said
};

// Bytes and JSON grow together; the same calls give the same file. One thread.
class GlbContainer {
 public:
  // Everything but accessors, bufferViews and buffers, which finish() adds.
  nlohmann::ordered_json json;

  // All return the index of what they add. Views begin at multiples of 4 bytes.
  std::size_t add_view(std::string_view bytes, GltfTarget target = GltfTarget::kNone);
  std::size_t add_accessor(const GltfAccessor& accessor, std::string_view bytes, GltfTarget target);
  std::size_t add_accessor_without_bytes(const GltfAccessor& accessor);  // they are inside of something compressed

  // kTooLarge: a GLB counts its bytes with 32 bits.
  Result<std::string> finish();

 private:
  nlohmann::ordered_json accessors_ = nlohmann::ordered_json::array(), views_ = nlohmann::ordered_json::array();
  std::string bytes_;
};

// The values of a vector as bytes.
template <class Value>
std::string_view as_bytes(const std::vector<Value>& values) {
  return {reinterpret_cast<const char*>(values.data()), values.size() * sizeof(Value)};
}

}  // namespace hermite
