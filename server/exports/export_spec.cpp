#include "server/exports/export_spec.h"

#include <fmt/core.h>

#include <charconv>
#include <optional>

#include "server/store/scan_id.h"

namespace hermite::server {

namespace {

Error outside(const char* field, std::int64_t value, const std::string& limits) {
  return {ErrorCode::kInvalidArgument, fmt::format("{} is {}: expected {}", field, value, limits)};
}

Error no_such_format(std::string_view name) {
  std::string known;
  for (const ExportOffer& format : export_offers())
    known += (known.empty() ? "" : ", ") + std::string(format.name);
  return {ErrorCode::kNotFound, fmt::format("there is no format '{}'; known are {}", name, known)};
}

// "_s1000_t50000_f100_c"; empty without options.
std::string suffix_of(const MeshShape& shape) {
  std::string suffix;
  if (shape.simplify_um > 0) suffix += fmt::format("_s{}", shape.simplify_um);
  if (shape.triangles > 0) suffix += fmt::format("_t{}", shape.triangles);
  if (shape.fill_mm > 0) suffix += fmt::format("_f{}", shape.fill_mm);
  if (shape.closes) suffix += "_c";
  return suffix;
}

// None: not a suffix that suffix_of makes.
std::optional<MeshShape> shape_of_suffix(std::string_view suffix) {
  MeshShape shape;
  for (std::string_view rest = suffix; !rest.empty();) {
    const std::size_t end = std::min(rest.find('_', 1), rest.size());
    const std::string_view word = rest.substr(0, end);
    rest.remove_prefix(end);
    if (word.size() < 2 || word[0] != '_') return std::nullopt;
    if (word == "_c") {
      shape.closes = true;
      continue;
    }
    std::int64_t* const field = word[1] == 's'   ? &shape.simplify_um
                                : word[1] == 't' ? &shape.triangles
                                : word[1] == 'f' ? &shape.fill_mm
                                                 : nullptr;
    if (!field) return std::nullopt;
    const auto [last, error] = std::from_chars(word.data() + 2, word.data() + word.size(), *field);
    if (error != std::errc() || last != word.data() + word.size()) return std::nullopt;
  }
  return suffix_of(shape) == suffix ? std::optional(shape) : std::nullopt;
}

constexpr std::string_view kComparisonStem = "comparison_", kComparisonEnding = ".json",
                           kMarkStem = "compared-by_";

// Returns the id between both; empty if there is none.
std::string id_between(std::string_view text, std::string_view stem, std::string_view ending) {
  if (!text.starts_with(stem) || !text.ends_with(ending) ||
      text.size() < stem.size() + ending.size())
    return {};
  text.remove_prefix(stem.size());
  text.remove_suffix(ending.size());
  return is_scan_id(text) ? std::string(text) : std::string();
}

}  // namespace

std::string ExportSpec::name() const {
  return std::string(offer->name) + (is_comparison() ? "_" + other_scan_id : suffix_of(shape));
}

std::string ExportSpec::file() const {
  if (is_comparison())
    return std::string(kComparisonStem) + other_scan_id + std::string(kComparisonEnding);
  std::string file(offer->file);
  return file.insert(file.find('.'), suffix_of(shape));
}

std::vector<std::string> ExportSpec::files() const {
  if (is_comparison()) return {comparison_points_file(other_scan_id), file()};
  if (is_viewer_mesh()) return {kMeshThumbnailFile, file()};
  return {file()};
}

ExportSpec comparison_with(const std::string& other_scan_id) {
  return {&comparison_offer(), {}, other_scan_id};
}

std::string comparison_points_file(const std::string& other_scan_id) {
  return fmt::format("{}{}.ply", kComparisonStem, other_scan_id);
}

std::string compared_scan_of_file(std::string_view file) {
  return id_between(file, kComparisonStem, kComparisonEnding);
}

std::string comparison_mark(const std::string& first_scan_id) {
  return std::string(kMarkStem) + first_scan_id;
}

std::string first_scan_of_mark(std::string_view file) { return id_between(file, kMarkStem, ""); }

Status check_shape(const ExportOffer& offer, const MeshShape& shape) {
  if (!shape.is_plain() && offer.kind != ExportKind::kMesh)
    return Error{ErrorCode::kInvalidArgument,
                 std::string(offer.name) + " is no mesh, of which alone there are options"};
  if (!shape.is_plain() && offer.is_result)
    return Error{
        ErrorCode::kInvalidArgument,
        std::string(offer.name) + " is kept as it came: there are options of what is made of it"};
  if (shape.simplify_um != 0 &&
      (shape.simplify_um < kLeastSimplify_um || shape.simplify_um > kMostSimplify_um))
    return outside("simplify_um", shape.simplify_um,
                   fmt::format("0, or {} to {}", kLeastSimplify_um, kMostSimplify_um));
  if (shape.triangles < 0 || shape.triangles > kMostMeshTriangles)
    return outside("triangles", shape.triangles, fmt::format("0 to {}", kMostMeshTriangles));
  if (shape.triangles > 0 && shape.simplify_um == 0)
    return Error{ErrorCode::kInvalidArgument,
                 "triangles says where simplifying stops, and needs simplify_um"};
  if (shape.fill_mm < 0 || shape.fill_mm > kMostFill_mm)
    return outside("fill_holes_mm", shape.fill_mm, fmt::format("0 to {}", kMostFill_mm));
  return Done{};
}

Result<ExportSpec> export_spec_named(std::string_view name) {
  const std::size_t end = std::min(name.find('_'), name.size());
  const ExportOffer* const offer = find_export_offer(name.substr(0, end));
  const std::optional<MeshShape> shape = shape_of_suffix(name.substr(end));
  if (!offer || !shape) return no_such_format(name);
  if (const Status checked = check_shape(*offer, *shape); !checked.ok()) return checked.error();
  return ExportSpec{offer, *shape};
}

ExportSpec shaped_export_of_file(std::string_view file) {
  for (const ExportOffer& offer : export_offers()) {
    const std::size_t dot = offer.file.find('.');
    const std::string_view stem = offer.file.substr(0, dot), ending = offer.file.substr(dot);
    if (!file.starts_with(stem) || !file.ends_with(ending) || file.size() <= offer.file.size())
      continue;
    const std::optional<MeshShape> shape =
        shape_of_suffix(file.substr(dot, file.size() - offer.file.size()));
    if (shape && !shape->is_plain() && check_shape(offer, *shape).ok()) return {&offer, *shape};
  }
  return {};
}

}  // namespace hermite::server
