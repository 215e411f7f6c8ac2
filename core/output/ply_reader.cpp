#include "core/output/ply_reader.h"

#include <fmt/core.h>

#include <algorithm>
#include <array>
#include <charconv>
#include <cstddef>
#include <cstring>
#include <optional>
#include <sstream>
#include <string>

namespace hermite::output {

namespace {

enum class Type { kInt8, kUint8, kInt16, kUint16, kInt32, kUint32, kFloat, kDouble };

struct Property {
  std::string name;
  Type type = Type::kFloat;
  std::optional<Type> count_type;  // set for a list
};

struct Element {
  std::string name;
  std::uint64_t count = 0;
  std::vector<Property> properties;
};

enum class Encoding { kAscii, kLittleEndian, kBigEndian };

struct Header {
  Encoding encoding = Encoding::kAscii;
  std::vector<Element> elements;
  std::vector<std::string> comments;
  std::size_t bytes = 0;
};

constexpr std::uint64_t kMostElements = 200'000'000;
constexpr std::uint64_t kLongestList = 1000;
constexpr std::size_t kLongestLine = 1000, kLongestHeader_bytes = std::size_t{64} << 10;

Error corrupt(const std::string& message) { return {ErrorCode::kCorruptData, "PLY: " + message}; }

std::optional<Type> type_named(const std::string& name) {
  static const std::vector<std::pair<const char*, Type>> names{
      {"char", Type::kInt8},     {"int8", Type::kInt8},     {"uchar", Type::kUint8},
      {"uint8", Type::kUint8},   {"short", Type::kInt16},   {"int16", Type::kInt16},
      {"ushort", Type::kUint16}, {"uint16", Type::kUint16}, {"int", Type::kInt32},
      {"int32", Type::kInt32},   {"uint", Type::kUint32},   {"uint32", Type::kUint32},
      {"float", Type::kFloat},   {"float32", Type::kFloat}, {"double", Type::kDouble},
      {"float64", Type::kDouble}};
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
    if (!property.count_type)
      return corrupt(fmt::format("a list has the invalid count type '{}'", count_type));
  }
  const std::optional<Type> known = type_named(type);
  if (!known) return corrupt(fmt::format("unknown type '{}'", type));
  property.type = *known;
  words >> property.name;
  return property;
}

// Checks that each element is declared once, so that columns of vertices have equal lengths, and
// has properties, so that reading consumes bytes and ends.
Status check_elements(const std::vector<Element>& elements) {
  for (auto element = elements.begin(); element != elements.end(); ++element) {
    const auto has_its_name = [&](const Element& other) { return other.name == element->name; };
    if (std::any_of(elements.begin(), element, has_its_name))
      return corrupt(fmt::format("element '{}' is declared twice", element->name));
    if (element->count > 0 && element->properties.empty())
      return corrupt(fmt::format("element '{}' has no properties", element->name));
  }
  return Done{};
}

Result<Header> parse_header(std::string_view bytes) {
  Header header;
  std::string format;
  bool first = true;
  while (true) {
    const std::size_t end = bytes.find('\n', header.bytes);
    if (end == std::string_view::npos || end - header.bytes > kLongestLine ||
        end > kLongestHeader_bytes)
      return corrupt(
          fmt::format("the header does not end: its lines may have {} bytes, all of it {}",
                      kLongestLine, kLongestHeader_bytes));
    const std::size_t start = header.bytes;
    std::istringstream words(std::string(bytes.substr(header.bytes, end - header.bytes)));
    header.bytes = end + 1;
    std::string keyword;
    words >> keyword;
    if (first && keyword != "ply") return corrupt("the file does not start with 'ply'");
    first = false;
    if (keyword == "end_header") break;
    if (keyword == "format") words >> format;
    if (keyword == "comment") header.comments.emplace_back(bytes.substr(start, end - start));
    if (keyword == "element") {
      Element element;
      words >> element.name >> element.count;
      if (words.fail() || element.count > kMostElements)
        return corrupt(
            fmt::format("element '{}' has no count of at most {}", element.name, kMostElements));
      header.elements.push_back(element);
    }
    if (keyword == "property") {
      if (header.elements.empty())
        return corrupt("a property is declared before the first element");
      Result<Property> property = parse_property(words);
      if (!property.ok()) return property.error();
      header.elements.back().properties.push_back(*std::move(property));
    }
  }
  if (format == "binary_little_endian")
    header.encoding = Encoding::kLittleEndian;
  else if (format == "binary_big_endian")
    header.encoding = Encoding::kBigEndian;
  else if (format != "ascii")
    return Error{ErrorCode::kUnsupported,
                 fmt::format("PLY: format '{}' is unknown; known are ascii, binary_little_endian "
                             "and binary_big_endian",
                             format)};
  const Status elements = check_elements(header.elements);
  if (!elements.ok()) return elements.error();
  return header;
}

// Reads consecutive numbers; `failed` becomes true when one is missing.
class Numbers {
 public:
  Numbers(std::string_view bytes, Encoding encoding) : bytes_(bytes), encoding_(encoding) {}

  double next(Type type) {
    if (encoding_ == Encoding::kAscii) return next_word();
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
  std::size_t bytes_left() const { return bytes_.size(); }

 private:
  template <class T>
  T next_binary() {
    T value{};
    if (bytes_.size() < sizeof(T)) {
      failed_ = true;
      return value;
    }
    std::array<char, sizeof(T)> raw;
    std::memcpy(raw.data(), bytes_.data(), sizeof(T));
    if (encoding_ == Encoding::kBigEndian) std::reverse(raw.begin(), raw.end());
    std::memcpy(&value, raw.data(), sizeof(T));
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
  const Encoding encoding_;
  bool failed_ = false;
};

// Returns the index of the element's property with this name, or -1.
std::ptrdiff_t place_of(const Element& element, const char* name) {
  const auto found = std::find_if(element.properties.begin(), element.properties.end(),
                                  [&](const Property& p) { return p.name == name; });
  return found == element.properties.end() ? -1 : found - element.properties.begin();
}

// Properties of an element that are only used if all of them exist.
template <std::size_t N>
class PlyColumns {
 public:
  PlyColumns(const Element& element, const std::array<const char*, N>& names) {
    for (std::size_t i = 0; i < N; ++i) places_[i] = place_of(element, names[i]);
    all_there_ = std::all_of(places_.begin(), places_.end(),
                             [](std::ptrdiff_t place) { return place >= 0; });
  }
  bool all_there() const { return all_there_; }
  std::size_t place(std::size_t which) const { return static_cast<std::size_t>(places_[which]); }
  Eigen::Matrix<float, static_cast<int>(N), 1> vector(const std::vector<double>& row) const {
    Eigen::Matrix<float, static_cast<int>(N), 1> values;
    for (std::size_t i = 0; i < N; ++i)
      values[static_cast<int>(i)] = static_cast<float>(row[place(i)]);
    return values;
  }

 private:
  std::array<std::ptrdiff_t, N> places_{};
  bool all_there_ = false;
};

// Returns a whole number from 0 to `most`; 0 for any other value.
std::uint32_t whole(double value, double most) {
  return value >= 0 && value <= most ? static_cast<std::uint32_t>(value) : 0;
}

// Converts one channel of a colour.
std::uint8_t byte_of(double value, Type type) {
  const double scale = type == Type::kUint16                           ? 1.0 / 257
                       : type == Type::kFloat || type == Type::kDouble ? 255.0
                                                                       : 1.0;
  return static_cast<std::uint8_t>(whole(value * scale + 0.5, 255.5));
}

struct VertexColumns {
  explicit VertexColumns(const Element& e)
      : position(e, {"x", "y", "z"}),
        normal(e, {"nx", "ny", "nz"}),
        color(e, {"red", "green", "blue"}),
        radius(e, {"radius"}),
        confidence(e, {"confidence"}),
        curvature(e, {"curvature_max", "curvature_min"}),
        submap(e, {"submap"}) {}

  Eigen::Vector3d position_of(const std::vector<double>& row) const {
    return {row[position.place(0)], row[position.place(1)], row[position.place(2)]};
  }

  void reserve(std::size_t count, PlyShape& shape) const {
    shape.positions.reserve(count);
    if (normal.all_there()) shape.normals.reserve(count);
    if (color.all_there()) shape.colors.reserve(count);
    if (radius.all_there()) shape.radii.reserve(count);
    if (confidence.all_there()) shape.confidences.reserve(count);
    if (curvature.all_there()) shape.curvatures.reserve(count);
    if (submap.all_there()) shape.submaps.reserve(count);
  }

  void append(const std::vector<double>& row, const Element& element, PlyShape& shape) const {
    shape.positions.push_back((position_of(row) - shape.origin).cast<float>());
    if (normal.all_there()) shape.normals.push_back(normal.vector(row));
    const auto channel = [&](std::size_t which) {
      return byte_of(row[color.place(which)], element.properties[color.place(which)].type);
    };
    if (color.all_there()) shape.colors.push_back({channel(0), channel(1), channel(2)});
    if (radius.all_there()) shape.radii.push_back(radius.vector(row)[0]);
    if (confidence.all_there()) shape.confidences.push_back(confidence.vector(row)[0]);
    if (curvature.all_there()) shape.curvatures.push_back(curvature.vector(row));
    if (submap.all_there()) shape.submaps.push_back(whole(row[submap.place(0)], 4294967295.0));
  }

  PlyColumns<3> position, normal, color;
  PlyColumns<1> radius, confidence;
  PlyColumns<2> curvature;
  PlyColumns<1> submap;
};

Error too_many(const char* what, std::uint64_t most) {
  return {ErrorCode::kTooLarge, fmt::format("PLY: more than {} {}", most, what)};
}

Status read_vertices(Numbers& numbers, const Element& element, const PlyOptions& options,
                     PlyShape& shape) {
  const VertexColumns columns(element);
  if (shape.positions.size() + element.count > options.most_vertices)
    return too_many("vertices", options.most_vertices);
  std::vector<double> row(element.properties.size());
  // Reserves the announced count, as far as there are bytes for it.
  columns.reserve(std::min<std::size_t>(
                      element.count, numbers.bytes_left() / std::max<std::size_t>(row.size(), 1)),
                  shape);
  bool origin_known = !options.subtract_origin;
  for (std::uint64_t i = 0; i < element.count; ++i) {
    for (std::size_t k = 0; k < row.size(); ++k) {
      if (element.properties[k].count_type)
        return Error{ErrorCode::kUnsupported, "PLY: vertices have a list property"};
      row[k] = numbers.next(element.properties[k].type);
    }
    if (!columns.position.all_there()) return corrupt("vertices lack x, y and z");
    if (numbers.failed()) return corrupt(fmt::format("cut at vertex {} of {}", i, element.count));
    if (!origin_known && columns.position_of(row).allFinite()) {
      shape.origin = origin_near(columns.position_of(row));
      origin_known = true;
    }
    columns.append(row, element, shape);
  }
  return Done{};
}

// Reads faces and other elements; the indices of a list named vertex_indices or vertex_index become
// triangles.
Status read_others(Numbers& numbers, const Element& element, const PlyOptions& options,
                   PlyShape& shape) {
  const bool is_face = element.name == "face",
             has_marks = is_face && place_of(element, "filled") >= 0;
  std::vector<double> values;
  for (std::uint64_t i = 0; i < element.count; ++i) {
    double is_filled = 0;
    for (const Property& property : element.properties) {
      const double length = property.count_type ? numbers.next(*property.count_type) : 1;
      if (numbers.failed() || !(length >= 0 && length <= static_cast<double>(kLongestList)))
        return corrupt(fmt::format("cut or damaged at {} {}", element.name, i));
      values.resize(static_cast<std::size_t>(length));
      for (double& value : values) value = numbers.next(property.type);
      if (numbers.failed()) return corrupt(fmt::format("cut at {} {}", element.name, i));
      if (is_face && property.name == "filled" && !values.empty()) is_filled = values[0];
      if (!is_face || (property.name != "vertex_indices" && property.name != "vertex_index"))
        continue;
      for (const double value : values)
        if (!(value >= 0 && value < static_cast<double>(shape.positions.size())))
          return corrupt(fmt::format("face {} names a vertex that is not there", i));
      if (shape.triangles.size() + values.size() > options.most_triangles + 2)
        return too_many("triangles", options.most_triangles);
      for (std::size_t k = 2; k < values.size(); ++k)
        shape.triangles.push_back({static_cast<std::uint32_t>(values[0]),
                                   static_cast<std::uint32_t>(values[k - 1]),
                                   static_cast<std::uint32_t>(values[k])});
    }
    if (has_marks) shape.is_filled.resize(shape.triangles.size(), is_filled != 0 ? 1 : 0);
  }
  return Done{};
}

}  // namespace

Eigen::Vector3d origin_near(const Eigen::Vector3d& position) {
  if (position.cwiseAbs().maxCoeff() <= kFarOff) return Eigen::Vector3d::Zero();
  return (position / kOriginStep).array().round() * kOriginStep;
}

Result<PlyShape> parse_ply(std::string_view bytes, const PlyOptions& options) {
  const Result<Header> header = parse_header(bytes);
  if (!header.ok()) return header.error();
  Numbers numbers(bytes.substr(header->bytes), header->encoding);
  PlyShape shape;
  shape.comments = header->comments;
  bool has_vertices = false;
  for (const Element& element : header->elements) {
    const Status read = element.name == "vertex" ? read_vertices(numbers, element, options, shape)
                                                 : read_others(numbers, element, options, shape);
    if (!read.ok()) return read.error();
    has_vertices = has_vertices || element.name == "vertex";
  }
  if (!has_vertices) return corrupt("there are no vertices");
  return shape;
}

}  // namespace hermite::output
