// GLB files made by hand. Header only.
#pragma once

#include <cstdint>
#include <cstring>
#include <nlohmann/json.hpp>
#include <string>
#include <vector>

namespace hermite::test {

inline std::string word_bytes(std::uint32_t word) {
  return {reinterpret_cast<const char*>(&word), sizeof word};
}

inline std::string glb_of(std::string json, std::string binary) {
  json.append((4 - json.size() % 4) % 4, ' ');
  binary.append((4 - binary.size() % 4) % 4, '\0');
  std::string chunks = word_bytes(static_cast<std::uint32_t>(json.size())) + "JSON" + json;
  if (!binary.empty())
    chunks +=
        word_bytes(static_cast<std::uint32_t>(binary.size())) + std::string("BIN\0", 4) + binary;
  return "glTF" + word_bytes(2) + word_bytes(static_cast<std::uint32_t>(12 + chunks.size())) +
         chunks;
}

inline std::string float_bytes(const std::vector<float>& values) {
  return {reinterpret_cast<const char*>(values.data()), values.size() * sizeof(float)};
}

// One triangle (0,0,0) (1,0,0) (0,1,0), y up, by three indices of 16 bits. Change the JSON, then
// glb_of(json.dump(), triangle_binary()).
inline std::string triangle_binary() {
  return float_bytes({0, 0, 0, 1, 0, 0, 0, 1, 0}) + std::string("\0\0\1\0\2\0", 6);
}
inline nlohmann::json triangle_json() {
  return nlohmann::json::parse(
      R"({"asset": {"version": "2.0"}, "scene": 0, "scenes": [{"nodes": [0]}],
    "nodes": [{"mesh": 0}],
    "meshes": [{"primitives": [{"attributes": {"POSITION": 0}, "indices": 1}]}],
    "buffers": [{"byteLength": 42}],
    "bufferViews": [{"buffer": 0, "byteLength": 36},
                    {"buffer": 0, "byteOffset": 36, "byteLength": 6}],
    "accessors": [{"bufferView": 0, "componentType": 5126, "type": "VEC3", "count": 3},
                  {"bufferView": 1, "componentType": 5123, "type": "SCALAR", "count": 3}]})");
}

}  // namespace hermite::test
