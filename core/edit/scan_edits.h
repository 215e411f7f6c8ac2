// What somebody has taken out of a finished scan: a list of edits, each applied to what the ones
// before it left. The results of the scan do not change: the list is applied to what is shown and
// to what is exported, so every edit can be taken back. Plain values.
#pragma once

#include <Eigen/Core>
#include <cstddef>
#include <cstdint>
#include <string>
#include <vector>

#include "core/base/result.h"

namespace hermite::edit {

inline constexpr std::size_t kMostEdits = 16;
inline constexpr double kFarthestEdit_m = 1000;  // of a box's faces from the world's origin
inline constexpr double kLeastPart_m = 0.01, kMostPart_m = 10;

// A box whose edges have these directions in the world of the scan.
struct EditBox {
  Eigen::Matrix3d axes = Eigen::Matrix3d::Identity();  // rows: unit vectors at right angles
  Eigen::Vector3d low_m = Eigen::Vector3d::Zero(), high_m = Eigen::Vector3d::Zero();

  bool holds(const Eigen::Vector3d& point_m) const {
    const Eigen::Vector3d along_m = axes * point_m;
    return (along_m.array() >= low_m.array()).all() && (along_m.array() <= high_m.array()).all();
  }
  bool operator==(const EditBox&) const = default;
};

enum class EditKind { kKeepInside, kRemoveInside, kRemoveFloating };
const char* name_of(EditKind kind);  // "keep_inside", "remove_inside", "remove_floating"

struct ScanEdit {
  EditKind kind = EditKind::kKeepInside;
  EditBox box;                // of kKeepInside and kRemoveInside
  double smaller_than_m = 0;  // of kRemoveFloating: the diagonal of a part's bounding box
  bool operator==(const ScanEdit&) const = default;
};

struct ScanEdits {
  std::int64_t version = 0;  // grows by one whenever the list changes; 0: it never has
  std::vector<ScanEdit> edits;
  bool operator==(const ScanEdits&) const = default;
};

// Parses {"version": 3, "edits": [{"kind": "keep_inside", "box": {"axes": [[x, y, z], ...],
// "low_m": [...], "high_m": [...]}}, {"kind": "remove_floating", "smaller_than_m": 0.3}]}.
// kInvalidArgument, with a message that names the field and the limit.
Result<ScanEdits> parse_scan_edits(const std::string& json);
std::string format_scan_edits(const ScanEdits& edits);

}  // namespace hermite::edit
