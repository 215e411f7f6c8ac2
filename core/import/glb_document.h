// The container of an untrusted binary glTF 2.0 file: its JSON and the byte ranges that the JSON
// refers to, all checked before use. It refers to the bytes it was parsed from, which must outlive
// it. Pure; const functions are thread-safe.
// https://registry.khronos.org/glTF/specs/2.0/glTF-2.0.html
#pragma once

#include <cstdint>
#include <nlohmann/json.hpp>
#include <optional>
#include <string>
#include <string_view>
#include <vector>

#include "core/base/result.h"

namespace hermite::imports {

inline constexpr std::size_t kMaxGlbJson_bytes = std::size_t{16} << 20;  // 100,000 nodes take 10 MB
// Limit for each kind: nodes, meshes, accessors, ...
inline constexpr std::size_t kMaxGlbObjects = 100'000;
inline constexpr std::size_t kMaxGlbDepth = 200;  // nesting of the JSON

class GlbDocument {
 public:
  using Json = nlohmann::json;

  // Returns kCorruptData naming the field when the container or JSON is invalid, or an array is too
  // long or not an array; kUnsupported for another version, an unknown required extension, or data
  // outside the file (a `uri`).
  static Result<GlbDocument> parse(std::string_view bytes);

  const Json& json() const { return json_; }

  // Return the number of objects of a kind ("nodes"), and one of them; kCorruptData when there is
  // no such object.
  std::size_t count(const char* kind) const;
  Result<const Json*> object(const char* kind, std::uint64_t index) const;

  // Returns the bytes of a bufferView; kCorruptData when they exceed the binary chunk.
  Result<std::string_view> view(std::uint64_t index) const;

 private:
  Json json_;
  std::string_view binary_;
};

Error glb_error(const std::string& message);  // kCorruptData, "GLB: ..."

// Returns a member that is an index, or nullopt when it is missing; kCorruptData when it is not an
// integer from 0 to `most`. `where` names the object in messages.
Result<std::optional<std::uint64_t>> glb_index(const nlohmann::json& object, const char* key,
                                               const std::string& where,
                                               std::uint64_t most = 0xffffffff);

// Returns a member that is an array of `count` finite numbers, or nullopt when it is missing;
// kCorruptData for anything else.
Result<std::optional<std::vector<double>>> glb_numbers(const nlohmann::json& object,
                                                       const char* key, std::size_t count,
                                                       const std::string& where);

// Returns a member that is an object; null when it is missing or not an object.
const nlohmann::json* glb_member(const nlohmann::json& object, const char* key);

}  // namespace hermite::imports
