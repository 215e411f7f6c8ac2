#include "core/import/glb_values.h"

#include <fmt/core.h>

#include <algorithm>
#include <array>
#include <cstring>
#include <limits>
#include <type_traits>

namespace hermite::imports {
namespace {

using Json = nlohmann::json;

enum Component : std::uint64_t {
  kInt8 = 5120,
  kUint8 = 5121,
  kInt16 = 5122,
  kUint16 = 5123,
  kUint32 = 5125,
  kFloat = 5126
};

std::uint64_t bytes_of(std::uint64_t component) {
  switch (component) {
    case kInt8:
    case kUint8: return 1;
    case kInt16:
    case kUint16: return 2;
    case kUint32:
    case kFloat: return 4;
    default: return 0;
  }
}

int components_of(const Json& accessor) {
  static constexpr std::array<const char*, 4> kTypes{"SCALAR", "VEC2", "VEC3", "VEC4"};
  const auto type = accessor.find("type");
  for (std::size_t i = 0; i < kTypes.size(); ++i)
    if (type != accessor.end() && *type == kTypes[i]) return static_cast<int>(i) + 1;
  return 0;
}

std::string name_of_accessor(std::uint64_t index) { return fmt::format("accessors[{}]", index); }

// An accessor whose bytes were checked to be inside its bufferView.
struct Layout {
  std::string_view bytes;  // from its first element on
  std::uint64_t count = 0, stride = 0, component = 0;
  int components = 0;
  bool normalized = false;
};

struct Fields {
  std::uint64_t view = 0, offset = 0, component = 0;
};

Result<Fields> fields_of(const Json& accessor, const std::string& where) {
  if (accessor.contains("sparse"))
    return Error{ErrorCode::kUnsupported, fmt::format("GLB: {} is sparse", where)};
  const auto view = glb_index(accessor, "bufferView", where),
             offset = glb_index(accessor, "byteOffset", where),
             component = glb_index(accessor, "componentType", where);
  for (const auto* field : {&view, &offset, &component})
    if (!field->ok()) return field->error();
  if (!*view) return glb_error(where + ".bufferView is missing");
  if (!*component || bytes_of(**component) == 0)
    return glb_error(where + ".componentType is missing or unknown");
  return Fields{**view, offset->value_or(0), **component};
}

Result<Layout> layout_of(const GlbDocument& document, std::uint64_t index, std::uint64_t most) {
  const Result<std::uint64_t> count = glb_element_count(document, index, most);
  if (!count.ok()) return count.error();
  const Json& accessor = **document.object("accessors", index);
  const std::string where = name_of_accessor(index);
  const Result<Fields> fields = fields_of(accessor, where);
  if (!fields.ok()) return fields.error();
  const Result<std::string_view> bytes = document.view(fields->view);
  if (!bytes.ok()) return bytes.error();
  Layout layout{{}, *count, 0, fields->component, components_of(accessor)};
  if (layout.components == 0)
    return Error{ErrorCode::kUnsupported,
                 fmt::format("GLB: {}.type is not SCALAR, VEC2, VEC3 or VEC4", where)};
  const auto normalized = accessor.find("normalized");
  layout.normalized = normalized != accessor.end() && *normalized == true;
  const std::uint64_t element =
      bytes_of(layout.component) * static_cast<std::uint64_t>(layout.components);
  const auto stride = glb_index(**document.object("bufferViews", fields->view), "byteStride",
                                fmt::format("bufferViews[{}]", fields->view), 252);
  if (!stride.ok()) return stride.error();
  layout.stride = stride->value_or(element);
  if (layout.stride < element)
    return glb_error(fmt::format("{} has elements of {} bytes with a stride of {}", where, element,
                                 layout.stride));
  const std::uint64_t size = *count == 0 ? 0 : layout.stride * (*count - 1) + element;
  if (fields->offset > bytes->size() || size > bytes->size() - fields->offset)
    return glb_error(fmt::format("{} has {} elements in bytes {} to {} of a bufferView of {}",
                                 where, *count, fields->offset, fields->offset + size,
                                 bytes->size()));
  layout.bytes = bytes->substr(static_cast<std::size_t>(fields->offset));
  return layout;
}

template <class T>
void append_elements(const Layout& layout, std::vector<float>& numbers) {
  for (std::uint64_t i = 0; i < layout.count; ++i)
    for (int k = 0; k < layout.components; ++k) {
      T value;
      std::memcpy(
          &value,
          layout.bytes.data() + i * layout.stride + static_cast<std::uint64_t>(k) * sizeof(T),
          sizeof(T));
      float number = static_cast<float>(value);
      if constexpr (std::is_integral_v<T>)
        if (layout.normalized)
          number = std::max(-1.0f, number / static_cast<float>(std::numeric_limits<T>::max()));
      numbers.push_back(number);
    }
}

template <class T>
void append_indices(const Layout& layout, std::vector<std::uint32_t>& indices) {
  for (std::uint64_t i = 0; i < layout.count; ++i) {
    T value;
    std::memcpy(&value, layout.bytes.data() + i * layout.stride, sizeof(T));
    indices.push_back(value);
  }
}

}  // namespace

Result<std::uint64_t> glb_element_count(const GlbDocument& document, std::uint64_t accessor,
                                        std::uint64_t most) {
  const Result<const Json*> object = document.object("accessors", accessor);
  if (!object.ok()) return object.error();
  const auto count = glb_index(**object, "count", name_of_accessor(accessor));
  if (!count.ok()) return count.error();
  if (!*count) return glb_error(name_of_accessor(accessor) + ".count is missing");
  if (**count > most)
    return Error{ErrorCode::kTooLarge, fmt::format("GLB: {}.count is {}, {} are left of the limit",
                                                   name_of_accessor(accessor), **count, most)};
  return **count;
}

Result<GlbValues> read_glb_values(const GlbDocument& document, std::uint64_t accessor,
                                  int least_components, int most_components, std::uint64_t most) {
  const Result<Layout> layout = layout_of(document, accessor, most);
  if (!layout.ok()) return layout.error();
  if (layout->components < least_components || layout->components > most_components)
    return glb_error(fmt::format(
        "{} has {} components, {}{} belong there", name_of_accessor(accessor), layout->components,
        least_components,
        least_components == most_components ? "" : " to " + std::to_string(most_components)));
  GlbValues values;
  values.components = layout->components;
  values.numbers.reserve(static_cast<std::size_t>(layout->count) *
                         static_cast<std::size_t>(layout->components));
  switch (layout->component) {
    case kInt8: append_elements<std::int8_t>(*layout, values.numbers); break;
    case kUint8: append_elements<std::uint8_t>(*layout, values.numbers); break;
    case kInt16: append_elements<std::int16_t>(*layout, values.numbers); break;
    case kUint16: append_elements<std::uint16_t>(*layout, values.numbers); break;
    case kUint32: append_elements<std::uint32_t>(*layout, values.numbers); break;
    default: append_elements<float>(*layout, values.numbers); break;
  }
  return values;
}

Result<std::vector<std::uint32_t>> read_glb_indices(const GlbDocument& document,
                                                    std::uint64_t accessor, std::uint64_t end,
                                                    std::uint64_t most) {
  const Result<Layout> layout = layout_of(document, accessor, most);
  if (!layout.ok()) return layout.error();
  if (layout->components != 1)
    return glb_error(name_of_accessor(accessor) + " has several components, indices have one");
  std::vector<std::uint32_t> indices;
  indices.reserve(static_cast<std::size_t>(layout->count));
  switch (layout->component) {
    case kUint8: append_indices<std::uint8_t>(*layout, indices); break;
    case kUint16: append_indices<std::uint16_t>(*layout, indices); break;
    case kUint32: append_indices<std::uint32_t>(*layout, indices); break;
    default:
      return glb_error(name_of_accessor(accessor) + ".componentType is not a type of indices");
  }
  for (std::size_t i = 0; i < indices.size(); ++i)
    if (indices[i] >= end)
      return glb_error(fmt::format("{}: index {} is {}, there are {} vertices",
                                   name_of_accessor(accessor), i, indices[i], end));
  return indices;
}

}  // namespace hermite::imports
