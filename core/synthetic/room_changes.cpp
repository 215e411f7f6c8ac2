#include "core/synthetic/room_changes.h"

#include <fmt/core.h>

#include <algorithm>
#include <cmath>
#include <cstddef>
#include <optional>

#include "core/dataset/text_file.h"

namespace hermite::synthetic {

namespace {

std::vector<std::string_view> parts_of(std::string_view text, char separator) {
  std::vector<std::string_view> parts;
  for (std::size_t begin = 0; begin <= text.size();) {
    const std::size_t end = std::min(text.find(separator, begin), text.size());
    parts.push_back(text.substr(begin, end - begin));
    begin = end + 1;
  }
  return parts;
}

std::string names_of(const Furniture& furniture) {
  std::string names;
  for (const NamedObject& object : furniture.objects)
    names += (names.empty() ? "" : ", ") + object.name;
  return names.empty() ? "none" : names;
}

void remove_object(Furniture& furniture, const NamedObject removed) {
  const std::size_t count = removed.last - removed.first;
  const auto begin = furniture.shapes.begin();
  furniture.shapes.erase(begin + static_cast<std::ptrdiff_t>(removed.first),
                         begin + static_cast<std::ptrdiff_t>(removed.last));
  std::erase_if(furniture.objects, [&](const NamedObject& object) {
    return removed.first <= object.first && object.last <= removed.last;
  });
  for (NamedObject& object : furniture.objects) {
    if (object.first >= removed.last) object.first -= count;
    if (object.last >= removed.last) object.last -= count;
  }
}

}  // namespace

Result<std::vector<RoomChange>> parse_moved_objects(std::string_view text) {
  std::vector<RoomChange> changes;
  for (const std::string_view part : parts_of(text, '/')) {
    const std::vector<std::string_view> fields = parts_of(part, ':');
    RoomChange change{std::string(fields.front()), Eigen::Vector3d::Zero(), false};
    bool is_valid = fields.size() == 4;
    for (std::size_t axis = 0; is_valid && axis < 3; ++axis) {
      const std::optional<double> moved_mm = dataset::parse_finite(fields[axis + 1]);
      is_valid = moved_mm && std::abs(*moved_mm) <= 1000 * kMostMove_m;
      if (is_valid) change.moved_m[static_cast<Eigen::Index>(axis)] = *moved_mm / 1000;
    }
    if (!is_valid)
      return Error{
          ErrorCode::kInvalidArgument,
          fmt::format("\"{}\" is not OBJECT:DX:DY:DZ in millimetres, each within +-1000", part)};
    changes.push_back(change);
  }
  return changes;
}

std::vector<RoomChange> parse_removed_objects(std::string_view text) {
  std::vector<RoomChange> changes;
  for (const std::string_view part : parts_of(text, '/'))
    changes.push_back({std::string(part), Eigen::Vector3d::Zero(), true});
  return changes;
}

Status apply_changes(const std::vector<RoomChange>& changes, Furniture& furniture) {
  for (const RoomChange& change : changes) {
    const auto object =
        std::find_if(furniture.objects.begin(), furniture.objects.end(),
                     [&](const NamedObject& candidate) { return candidate.name == change.object; });
    if (object == furniture.objects.end())
      return Error{ErrorCode::kInvalidArgument,
                   fmt::format("there is no object \"{}\" (there are: {})", change.object,
                               names_of(furniture))};
    for (std::size_t i = object->first; i < object->last; ++i)
      furniture.shapes[i].center += change.moved_m;
    if (change.is_removed) remove_object(furniture, *object);
  }
  return Done{};
}

}  // namespace hermite::synthetic
