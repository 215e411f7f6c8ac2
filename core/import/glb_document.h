// The container of an untrusted binary glTF 2.0: its JSON and the byte ranges that the JSON refers to, all of which are checked before use.
// Refers to the bytes that it was parsed from. Pure; const functions are thread-safe.
// https://registry.khronos.org/glTF/specs/2.0/glTF-2.0.html
#pragma once

#include <cstdint>
#include <nlohmann/json.hpp>
#include <optional>
#include <string>
#include <string_view>
#include <vector>

#include "core/base/result.h"

namespace hermite {

inline constexpr std::size_t kMaxGlbJson_bytes = std::size_t{16} << 20;  // 100,000 nodes take 10 MB
inline constexpr std::size_t kMaxGlbObjects = 100'000;                   // of each kind: nodes, meshes, accessors, ...
inline constexpr std::size_t kMaxGlbDepth = 200;                         // nesting of the JSON

class GlbDocument {
 public:
  using Json = nlohmann::json;

  // kCorruptData, naming the field: an invalid container or JSON, or an array that is too long or not an array; kUnsupported: another
  // version, an unknown required extension, or data outside of the file (a `uri`).
  static Result<GlbDocument> parse(std::string_view bytes);

  const Json& json() const { return json_; }

  // How many objects of a kind ("nodes") there are, and one of them. kCorruptData: there is no such object.
  std::size_t count(const char* kind) const;
  Result<const Json*> object(const char* kind, std::uint64_t index) const;

  // The bytes of a bufferView. kCorruptData: it exceeds the binary chunk.
  Result<std::string_view> view(std::uint64_t index) const;

 private:
  Json json_;
  std::string_view binary_;
};

Error glb_error(const std::string& words);  // kCorruptData, "GLB: ..."

// A member that is an index; none when it is missing. kCorruptData: not an integer from 0 to `most`. `where` is used in the message.
Result<std::optional<std::uint64_t>> glb_index(const nlohmann::json& object, const char* key, const std::string& where,
                                               std::uint64_t most = 0xffffffff);

// A member that is an array of `count` finite numbers; none when it is missing. kCorruptData: anything else.
Result<std::optional<std::vector<double>>> glb_numbers(const nlohmann::json& object, const char* key, std::size_t count,
                                                       const std::string& where);

// A member that is an object; null when it is missing or not an object.
const nlohmann::json* glb_member(const nlohmann::json& object, const char* key);

}  // namespace hermite
