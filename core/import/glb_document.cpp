#include "core/import/glb_document.h"

#include <fmt/core.h>

#include <algorithm>
#include <array>
#include <cmath>
#include <cstring>

namespace hermite::imports {
namespace {

using Json = nlohmann::json;

constexpr std::uint32_t kMagic = 0x46546C67, kVersion = 2, kJsonKind = 0x4E4F534A,
                        kBinaryKind = 0x004E4942;
constexpr std::size_t kHeader_bytes = 12, kChunkHeader_bytes = 8;
constexpr std::array kKinds = {"scenes",  "nodes",     "meshes",   "accessors", "bufferViews",
                               "buffers", "materials", "textures", "images"};
// Extensions that the viewer and this reader support. Material extensions are accepted as well,
// because they change how a surface looks and not where it is.
constexpr std::array kKnownExtensions = {"KHR_draco_mesh_compression", "KHR_mesh_quantization",
                                         "KHR_texture_transform"};
constexpr std::string_view kMaterials = "KHR_materials_";

Error unsupported(const std::string& message) {
  return {ErrorCode::kUnsupported, "GLB: " + message};
}

std::uint32_t word_at(std::string_view bytes, std::size_t at) {
  std::uint32_t word = 0;
  std::memcpy(&word, bytes.data() + at, sizeof word);
  return word;
}

std::string printable(std::string text) {
  text.resize(std::min<std::size_t>(text.size(), 60));
  for (char& letter : text)
    if (letter < ' ' || letter > '~') letter = '?';
  return text;
}

// Returns the chunk that begins at `at`, which must be of the given kind.
Result<std::string_view> chunk_at(std::string_view bytes, std::size_t at, std::uint32_t kind,
                                  const char* name) {
  if (bytes.size() - at < kChunkHeader_bytes)
    return glb_error(fmt::format("the header of the {} chunk is cut", name));
  const std::uint32_t length = word_at(bytes, at);
  if (word_at(bytes, at + 4) != kind)
    return glb_error(fmt::format("there is another chunk where the {} chunk belongs", name));
  if (bytes.size() - at - kChunkHeader_bytes < length)
    return glb_error(fmt::format("the {} chunk has {} bytes, the file has {} left", name, length,
                                 bytes.size() - at - kChunkHeader_bytes));
  return bytes.substr(at + kChunkHeader_bytes, length);
}

Result<Json> parse_json(std::string_view text) {
  if (text.size() > kMaxGlbJson_bytes)
    return Error{ErrorCode::kTooLarge, fmt::format("GLB: the JSON has {} bytes, the limit is {}",
                                                   text.size(), kMaxGlbJson_bytes)};
  bool too_deep = false;
  const Json::parser_callback_t depth_of = [&too_deep](int depth, Json::parse_event_t, Json&) {
    too_deep = too_deep || depth > static_cast<int>(kMaxGlbDepth);
    return !too_deep;
  };
  Json json = Json::parse(text, depth_of, false);
  if (too_deep) return glb_error("the JSON is nested deeper than " + std::to_string(kMaxGlbDepth));
  if (!json.is_object()) return glb_error("the JSON is not an object or is damaged");
  return json;
}

Status check_arrays(const Json& json) {
  for (const char* kind : kKinds) {
    const auto found = json.find(kind);
    if (found == json.end()) continue;
    if (!found->is_array()) return glb_error(std::string(kind) + " is not an array");
    if (found->size() > kMaxGlbObjects)
      return Error{ErrorCode::kTooLarge, fmt::format("GLB: {} has {} entries, the limit is {}",
                                                     kind, found->size(), kMaxGlbObjects)};
    for (std::size_t i = 0; i < found->size(); ++i)
      if (!(*found)[i].is_object())
        return glb_error(fmt::format("{}[{}] is not an object", kind, i));
  }
  return Done{};
}

Status check_extensions(const Json& json) {
  const auto required = json.find("extensionsRequired");
  if (required == json.end()) return Done{};
  if (!required->is_array()) return glb_error("extensionsRequired is not an array");
  for (const Json& name : *required) {
    const std::string text = name.is_string() ? name.get<std::string>() : "";
    if (text.starts_with(kMaterials) ||
        std::find(kKnownExtensions.begin(), kKnownExtensions.end(), text) != kKnownExtensions.end())
      continue;
    std::string known;
    for (const char* extension : kKnownExtensions) known += std::string(extension) + ", ";
    return unsupported(fmt::format("extensionsRequired has '{}'; known are {}{}*", printable(text),
                                   known, kMaterials));
  }
  return Done{};
}

Status check_inside(const Json& json, std::size_t binary_bytes) {
  for (const char* kind : {"buffers", "images"})
    if (const auto found = json.find(kind); found != json.end())
      for (std::size_t i = 0; i < found->size(); ++i)
        if ((*found)[i].contains("uri"))
          return unsupported(
              fmt::format("{}[{}] has a uri: everything must be inside of the file", kind, i));
  const auto buffers = json.find("buffers");
  if (buffers == json.end() || buffers->empty()) return Done{};
  if (buffers->size() > 1)
    return glb_error(
        fmt::format("there are {} buffers, a GLB without a uri has one", buffers->size()));
  const auto length = glb_index((*buffers)[0], "byteLength", "buffers[0]");
  if (!length.ok()) return length.error();
  // The chunk may have up to three bytes more.
  if (!*length || **length > binary_bytes)
    return glb_error(fmt::format("buffers[0].byteLength is {}, the binary chunk has {} bytes",
                                 *length ? std::to_string(**length) : "missing", binary_bytes));
  return Done{};
}

}  // namespace

Error glb_error(const std::string& message) { return {ErrorCode::kCorruptData, "GLB: " + message}; }

Result<GlbDocument> GlbDocument::parse(std::string_view bytes) {
  if (bytes.size() < kHeader_bytes || word_at(bytes, 0) != kMagic)
    return glb_error("the file does not start with 'glTF' and its length");
  if (word_at(bytes, 4) != kVersion)
    return unsupported(fmt::format("version {}, known is 2", word_at(bytes, 4)));
  if (word_at(bytes, 8) > bytes.size())
    return glb_error(fmt::format("it says that it has {} bytes, there are {}: cut?",
                                 word_at(bytes, 8), bytes.size()));
  bytes = bytes.substr(0, std::max<std::size_t>(word_at(bytes, 8), kHeader_bytes));
  const Result<std::string_view> text = chunk_at(bytes, kHeader_bytes, kJsonKind, "JSON");
  if (!text.ok()) return text.error();
  const std::size_t behind = kHeader_bytes + kChunkHeader_bytes + text->size();
  GlbDocument document;
  if (behind < bytes.size()) {
    const Result<std::string_view> binary = chunk_at(bytes, behind, kBinaryKind, "binary");
    if (!binary.ok()) return binary.error();
    document.binary_ = *binary;
  }
  Result<Json> json = parse_json(*text);
  if (!json.ok()) return json.error();
  document.json_ = *std::move(json);
  for (const Status& status : {check_arrays(document.json_), check_extensions(document.json_)})
    if (!status.ok()) return status.error();
  if (const Status status = check_inside(document.json_, document.binary_.size()); !status.ok())
    return status.error();
  return document;
}

std::size_t GlbDocument::count(const char* kind) const {
  const auto found = json_.find(kind);
  return found == json_.end() ? 0 : found->size();
}

Result<const Json*> GlbDocument::object(const char* kind, std::uint64_t index) const {
  if (index >= count(kind))
    return glb_error(fmt::format("there is no {}[{}], there are {}", kind, index, count(kind)));
  return &json_.at(kind)[static_cast<std::size_t>(index)];
}

Result<std::string_view> GlbDocument::view(std::uint64_t index) const {
  const Result<const Json*> view = object("bufferViews", index);
  if (!view.ok()) return view.error();
  const std::string where = fmt::format("bufferViews[{}]", index);
  const auto buffer = glb_index(**view, "buffer", where),
             offset = glb_index(**view, "byteOffset", where),
             length = glb_index(**view, "byteLength", where);
  for (const auto* field : {&buffer, &offset, &length})
    if (!field->ok()) return field->error();
  if (!*buffer || **buffer != 0 || count("buffers") == 0)
    return glb_error(where + ".buffer is not the one buffer of the file");
  if (!*length) return glb_error(where + ".byteLength is missing");
  const std::uint64_t begin = offset->value_or(0), size = **length;
  if (begin > binary_.size() || size > binary_.size() - begin)
    return glb_error(fmt::format("{} has bytes {} to {}, the binary chunk has {}", where, begin,
                                 begin + size, binary_.size()));
  return binary_.substr(static_cast<std::size_t>(begin), static_cast<std::size_t>(size));
}

Result<std::optional<std::uint64_t>> glb_index(const Json& object, const char* key,
                                               const std::string& where, std::uint64_t most) {
  const auto found = object.find(key);
  if (found == object.end()) return std::optional<std::uint64_t>();
  // Some writers have 3.0 for 3.
  const bool whole =
      found->is_number_unsigned() ||
      (found->is_number_float() && found->get<double>() >= 0 && found->get<double>() <= 9e15 &&
       std::floor(found->get<double>()) == found->get<double>());
  if (!whole) return glb_error(fmt::format("{}.{} is not a whole number", where, key));
  const auto value = found->is_number_unsigned() ? found->get<std::uint64_t>()
                                                 : static_cast<std::uint64_t>(found->get<double>());
  if (value > most)
    return glb_error(fmt::format("{}.{} is {}, the limit is {}", where, key, value, most));
  return std::optional<std::uint64_t>(value);
}

Result<std::optional<std::vector<double>>> glb_numbers(const Json& object, const char* key,
                                                       std::size_t count,
                                                       const std::string& where) {
  const auto found = object.find(key);
  if (found == object.end()) return std::optional<std::vector<double>>();
  const Error wrong = glb_error(fmt::format("{}.{} is not {} finite numbers", where, key, count));
  if (!found->is_array() || found->size() != count) return wrong;
  std::vector<double> numbers;
  for (const Json& number : *found) {
    if (!number.is_number() || !std::isfinite(number.get<double>())) return wrong;
    numbers.push_back(number.get<double>());
  }
  return std::optional(std::move(numbers));
}

const Json* glb_member(const Json& object, const char* key) {
  const auto found = object.find(key);
  return found == object.end() || !found->is_object() ? nullptr : &*found;
}

}  // namespace hermite::imports
