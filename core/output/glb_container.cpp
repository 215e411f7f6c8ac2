#include "core/output/glb_container.h"

#include <fmt/core.h>

#include <limits>

namespace hermite::output {
namespace {

using Json = nlohmann::ordered_json;

constexpr std::uint32_t kGlbMagic = 0x46546C67, kGlbVersion = 2, kJsonChunk = 0x4E4F534A,
                        kBinaryChunk = 0x004E4942;

void append_word(std::string& bytes, std::uint32_t word) {
  bytes.append(reinterpret_cast<const char*>(&word), sizeof word);
}

void pad_to_words(std::string& bytes, char with) { bytes.append((4 - bytes.size() % 4) % 4, with); }

}  // namespace

std::size_t GlbContainer::add_view(std::string_view bytes, GltfTarget target) {
  Json view{{"buffer", 0}, {"byteOffset", bytes_.size()}, {"byteLength", bytes.size()}};
  if (target != GltfTarget::kNone) view["target"] = static_cast<int>(target);
  views_.push_back(view);
  bytes_.append(bytes);
  pad_to_words(bytes_, '\0');
  return views_.size() - 1;
}

std::size_t GlbContainer::add_accessor(const GltfAccessor& accessor, std::string_view bytes,
                                       GltfTarget target) {
  const std::size_t view = add_view(bytes, target), index = add_accessor_without_bytes(accessor);
  accessors_[index]["bufferView"] = view;
  return index;
}

std::size_t GlbContainer::add_accessor_without_bytes(const GltfAccessor& accessor) {
  Json added{{"componentType", static_cast<int>(accessor.component)},
             {"count", accessor.count},
             {"type", accessor.type}};
  if (accessor.is_normalized) added["normalized"] = true;
  if (!accessor.min.empty()) added["min"] = accessor.min;
  if (!accessor.max.empty()) added["max"] = accessor.max;
  accessors_.push_back(added);
  return accessors_.size() - 1;
}

Result<std::string> GlbContainer::finish() {
  json["accessors"] = accessors_;
  json["bufferViews"] = views_;
  json["buffers"] = Json::array({Json{{"byteLength", bytes_.size()}}});
  std::string text = json.dump();
  pad_to_words(text, ' ');
  const std::uint64_t size = 12 + 8 + text.size() + 8 + std::uint64_t{bytes_.size()};
  if (size > std::numeric_limits<std::uint32_t>::max())
    return Error{ErrorCode::kTooLarge,
                 fmt::format("GLB of {} bytes, the format ends at 4 GiB", size)};
  std::string file;
  file.reserve(size);
  for (const std::uint32_t word : {kGlbMagic, kGlbVersion, static_cast<std::uint32_t>(size),
                                   static_cast<std::uint32_t>(text.size()), kJsonChunk})
    append_word(file, word);
  file += text;
  append_word(file, static_cast<std::uint32_t>(bytes_.size()));
  append_word(file, kBinaryChunk);
  file += bytes_;
  return file;
}

}  // namespace hermite::output
