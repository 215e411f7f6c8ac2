// The container of a binary glTF 2.0 that somebody has sent, its JSON and the ranges of bytes that the JSON names: nothing is believed
// before it is checked. Views into the bytes it was made of. Pure; const functions are thread-safe.
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
inline constexpr std::size_t kMaxGlbDepth = 200;                         // of brackets in the JSON

class GlbDocument {
 public:
  using Json = nlohmann::json;

  // kCorruptData, naming the field: the container, the JSON, an array that is none or too long; kUnsupported: another version, an extension
  // that is required and not known here, bytes outside of the file (a `uri`).
  static Result<GlbDocument> parse(std::string_view bytes);

  const Json& json() const { return json_; }

  // How many there are of a kind ("nodes"), and one of them, an object. kCorruptData: there is no such one.
  std::size_t count(const char* kind) const;
  Result<const Json*> object(const char* kind, std::uint64_t index) const;

  // kCorruptData: it leaves the binary part.
  Result<std::string_view> view(std::uint64_t index) const;

 private:
  Json json_;
  std::string_view binary_;
};

Error glb_error(const std::string& words);  // kCorruptData, "GLB: ..."

// Of a member of an object: none when it is missing. kCorruptData: there is something else, or not from 0 to `most`. `where` is for words.
Result<std::optional<std::uint64_t>> glb_index(const nlohmann::json& object, const char* key, const std::string& where,
                                               std::uint64_t most = 0xffffffff);

// Finite numbers, as many as there must be; none when the member is missing. kCorruptData.
Result<std::optional<std::vector<double>>> glb_numbers(const nlohmann::json& object, const char* key, std::size_t count,
                                                       const std::string& where);

// A member that is an object; null when it is missing or something else.
const nlohmann::json* glb_member(const nlohmann::json& object, const char* key);

}  // namespace hermite
