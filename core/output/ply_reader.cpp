#include "core/output/ply_reader.h"

#include <algorithm>
#include <array>
#include <charconv>
#include <cstddef>
#include <cstring>
#include <optional>
#include <sstream>
#include <string>

namespace hermite {

namespace {

enum class Type { kInt8, kUint8, kInt16, kUint16, kInt32, kUint32, kFloat, kDouble };

struct Property {
  std::string name;
  Type type = Type::kFloat;
  std::optional<Type> count_type;  // of a list
};

struct Element {
  std::string name;
  std::uint64_t count = 0;
  std::vector<Property> properties;
};

struct Header {
  bool ascii = false;
  std::vector<Element> elements;
  std::size_t bytes = 0;
};

constexpr std::uint64_t kMostElements = 200'000'000;
constexpr std::uint64_t kLongestList = 1000;

Error corrupt(const std::string& words) { return {ErrorCode::kCorruptData, "PLY: " + words}; }

std::optional<Type> type_named(const std::string& name) {
  static const std::vector<std::pair<const char*, Type>> names{
      {"char", Type::kInt8},   {"int8", Type::kInt8},     {"uchar", Type::kUint8},   {"uint8", Type::kUint8},
      {"short", Type::kInt16}, {"int16", Type::kInt16},   {"ushort", Type::kUint16}, {"uint16", Type::kUint16},
      {"int", Type::kInt32},   {"int32", Type::kInt32},   {"uint", Type::kUint32},   {"uint32", Type::kUint32},
      {"float", Type::kFloat}, {"float32", Type::kFloat}, {"double", Type::kDouble}, {"float64", Type::kDouble}};
  for (const auto& [known, type] : names)
    if (name == known) return type;
  return std::nullopt;
}

Result<Property> parse_property(std::istringstream& words) {
  Property property;
  std::string type, count_type;
  words >> type;
  if (type == "list") {
    words >> count_type >> type;
    property.count_type = type_named(count_type);
    if (!property.count_type) return corrupt("a list counts in '" + count_type + "'");
  }
  const std::optional<Type> known = type_named(type);
  if (!known) return corrupt("there is no type '" + type + "'");
  property.type = *known;
  words >> property.name;
  return property;
}

Result<Header> parse_header(std::string_view bytes) {
  Header header;
  std::string format;
  bool first = true;
  while (true) {
    const std::size_t end = bytes.find('\n', header.bytes);
    if (end == std::string_view::npos || end - header.bytes > 1000) return corrupt("the header does not end");
    std::istringstream words(std::string(bytes.substr(header.bytes, end - header.bytes)));
    header.bytes = end + 1;
    std::string keyword;
    words >> keyword;
    if (first && keyword != "ply") return corrupt("the file does not start with 'ply'");
    first = false;
    if (keyword == "end_header") break;
    if (keyword == "format") words >> format;
    if (keyword == "element") {
      Element element;
      words >> element.name >> element.count;
      if (words.fail() || element.count > kMostElements)
        return corrupt("element '" + element.name + "' has no count of at most " + std::to_string(kMostElements));
      header.elements.push_back(element);
    }
    if (keyword == "property") {
      if (header.elements.empty()) return corrupt("a property before the first element");
      Result<Property> property = parse_property(words);
      if (!property.ok()) return property.error();
      header.elements.back().properties.push_back(*std::move(property));
    }
  }
  if (format != "ascii" && format != "binary_little_endian")
    return Error{ErrorCode::kUnsupported, "PLY: format '" + format + "', known are ascii and binary_little_endian"};
  header.ascii = format == "ascii";
  return header;
}

// Reads numbers one after the other; `failed` once one is missing.
class Numbers {
 public:
  Numbers(std::string_view bytes, bool ascii) : bytes_(bytes), ascii_(ascii) {}

  double next(Type type) {
    if (ascii_) return next_word();
    switch (type) {
      case Type::kInt8: return next_binary<std::int8_t>();
      case Type::kUint8: return next_binary<std::uint8_t>();
      case Type::kInt16: return next_binary<std::int16_t>();
      case Type::kUint16: return next_binary<std::uint16_t>();
      case Type::kInt32: return next_binary<std::int32_t>();
      case Type::kUint32: return next_binary<std::uint32_t>();
      case Type::kFloat: return static_cast<double>(next_binary<float>());
      case Type::kDouble: return next_binary<double>();
    }
    return 0;
  }
  bool failed() const { return failed_; }

 private:
  template <class T>
  T next_binary() {
    T value{};
    if (bytes_.size() < sizeof(T)) {
      failed_ = true;
      return value;
    }
    std::memcpy(&value, bytes_.data(), sizeof(T));
    bytes_.remove_prefix(sizeof(T));
    return value;
  }
  double next_word() {
    bytes_.remove_prefix(std::min(bytes_.find_first_not_of(" \t\r\n"), bytes_.size()));
    double value = 0;
    const auto [end, error] = std::from_chars(bytes_.data(), bytes_.data() + bytes_.size(), value);
    failed_ = failed_ || error != std::errc();
    bytes_.remove_prefix(static_cast<std::size_t>(end - bytes_.data()));
    return value;
  }

  std::string_view bytes_;
  const bool ascii_;
  bool failed_ = false;
};

// Which property of an element has this name, or -1.
std::ptrdiff_t place_of(const Element& element, const char* name) {
  const auto found = std::find_if(element.properties.begin(), element.properties.end(), [&](const Property& p) { return p.name == name; });
  return found == element.properties.end() ? -1 : found - element.properties.begin();
}

// Which properties of a vertex are there, by what they are of.
struct VertexPlaces {
  std::array<std::ptrdiff_t, 3> position{}, normal{}, color{};
  std::ptrdiff_t radius = -1, confidence = -1;
};

bool all_there(const std::array<std::ptrdiff_t, 3>& places) {
  return std::all_of(places.begin(), places.end(), [](std::ptrdiff_t place) { return place >= 0; });
}

// A byte as it is; a real number from 0 to 1 as a share of 255.
std::uint8_t color_byte(float value, Type type) {
  const bool is_real = type == Type::kFloat || type == Type::kDouble;
  const float scaled = is_real ? 255 * value : value;
  return scaled > 0 ? static_cast<std::uint8_t>(std::min(scaled + 0.5f, 255.0f)) : std::uint8_t{0};
}

void add_vertex(const std::vector<float>& values, const VertexPlaces& places, const Element& element, PlyShape& shape) {
  const auto value = [&values](std::ptrdiff_t place) { return values[static_cast<std::size_t>(place)]; };
  const auto vector = [&](const std::array<std::ptrdiff_t, 3>& of) { return Eigen::Vector3f(value(of[0]), value(of[1]), value(of[2])); };
  shape.positions.push_back(vector(places.position));
  if (all_there(places.normal)) shape.normals.push_back(vector(places.normal));
  if (places.radius >= 0) shape.radii.push_back(value(places.radius));
  if (places.confidence >= 0) shape.confidences.push_back(value(places.confidence));
  if (!all_there(places.color)) return;
  const auto byte = [&](std::size_t i) {
    const std::ptrdiff_t place = places.color[i];
    return color_byte(value(place), element.properties[static_cast<std::size_t>(place)].type);
  };
  shape.colors.push_back({byte(0), byte(1), byte(2)});
}

Status read_vertices(Numbers& numbers, const Element& element, PlyShape& shape) {
  const auto place = [&element](const char* name) { return place_of(element, name); };
  const VertexPlaces places{{place("x"), place("y"), place("z")},
                            {place("nx"), place("ny"), place("nz")},
                            {place("red"), place("green"), place("blue")},
                            place("radius"),
                            place("confidence")};
  std::vector<float> values(element.properties.size());
  for (std::uint64_t i = 0; i < element.count; ++i) {
    for (std::size_t k = 0; k < values.size(); ++k) {
      if (element.properties[k].count_type) return Error{ErrorCode::kUnsupported, "PLY: a vertex with a list"};
      values[k] = static_cast<float>(numbers.next(element.properties[k].type));
    }
    if (!all_there(places.position)) return corrupt("vertices without x, y and z");
    if (numbers.failed()) return corrupt("cut at vertex " + std::to_string(i) + " of " + std::to_string(element.count));
    add_vertex(values, places, element, shape);
  }
  return Done{};
}

// Faces and whatever else; the indices of a list named vertex_indices or vertex_index become triangles.
Status read_others(Numbers& numbers, const Element& element, PlyShape& shape) {
  for (std::uint64_t i = 0; i < element.count; ++i)
    for (const Property& property : element.properties) {
      const double length = property.count_type ? numbers.next(*property.count_type) : 1;
      if (numbers.failed() || !(length >= 0 && length <= static_cast<double>(kLongestList)))
        return corrupt("cut or damaged at " + element.name + " " + std::to_string(i));
      std::vector<double> values(static_cast<std::size_t>(length));
      for (double& value : values) value = numbers.next(property.type);
      if (numbers.failed()) return corrupt("cut at " + element.name + " " + std::to_string(i));
      if (element.name != "face" || (property.name != "vertex_indices" && property.name != "vertex_index")) continue;
      for (const double value : values)
        if (!(value >= 0 && value < static_cast<double>(shape.positions.size())))
          return corrupt("face " + std::to_string(i) + " names a vertex that is not there");
      for (std::size_t k = 2; k < values.size(); ++k)
        shape.triangles.push_back(
            {static_cast<std::uint32_t>(values[0]), static_cast<std::uint32_t>(values[k - 1]), static_cast<std::uint32_t>(values[k])});
    }
  return Done{};
}

}  // namespace

Result<PlyShape> parse_ply(std::string_view bytes) {
  const Result<Header> header = parse_header(bytes);
  if (!header.ok()) return header.error();
  Numbers numbers(bytes.substr(header->bytes), header->ascii);
  PlyShape shape;
  bool has_vertices = false;
  for (const Element& element : header->elements) {
    const Status read = element.name == "vertex" ? read_vertices(numbers, element, shape) : read_others(numbers, element, shape);
    if (!read.ok()) return read.error();
    has_vertices = has_vertices || element.name == "vertex";
  }
  if (!has_vertices) return corrupt("no vertices");
  return shape;
}

Result<Cloud> cloud_of(const PlyShape& shape, const std::string& name) {
  if (shape.positions.empty()) return Error{ErrorCode::kInvalidArgument, name + " has no points"};
  if (shape.normals.empty())
    return Error{ErrorCode::kInvalidArgument, name + " has points without normals (nx, ny, nz): the sides of its surface cannot be told"};
  Cloud cloud(shape.positions.size());
  for (std::size_t i = 0; i < cloud.size(); ++i) {
    cloud[i].position_m = shape.positions[i];
    cloud[i].normal = shape.normals[i];
    cloud[i].color = shape.colors.empty() ? Rgb8{255, 255, 255} : shape.colors[i];
    cloud[i].confidence = shape.confidences.empty() ? 1 : shape.confidences[i];
    if (!shape.radii.empty()) cloud[i].radius_m = shape.radii[i];
  }
  return cloud;
}

}  // namespace hermite
