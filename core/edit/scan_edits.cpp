#include "core/edit/scan_edits.h"

#include <fmt/core.h>

#include <array>
#include <cmath>
#include <nlohmann/json.hpp>

namespace hermite::edit {

namespace {

using Json = nlohmann::ordered_json;

constexpr std::array kKinds{EditKind::kKeepInside, EditKind::kRemoveInside,
                            EditKind::kRemoveFloating};
constexpr double kAxesSlack = 1e-3;  // of rounded numbers
constexpr double kThinnest_m = 1e-3;

Error wrong(const std::string& message) { return {ErrorCode::kInvalidArgument, message}; }

Result<Eigen::Vector3d> triple_in(const Json& json, const std::string& name, double limit) {
  if (!json.is_array() || json.size() != 3) return wrong(name + " must be three numbers");
  Eigen::Vector3d triple;
  for (std::size_t i = 0; i < 3; ++i) {
    if (!json[i].is_number()) return wrong(name + " must be three numbers");
    triple[static_cast<Eigen::Index>(i)] = json[i].get<double>();
    if (!(std::abs(triple[static_cast<Eigen::Index>(i)]) <= limit))
      return wrong(fmt::format("{}[{}] is {:g}, allowed are {:g} to {:g}", name, i,
                               json[i].get<double>(), -limit, limit));
  }
  return triple;
}

Result<Eigen::Matrix3d> axes_in(const Json& json, const std::string& name) {
  if (!json.is_array() || json.size() != 3) return wrong(name + " must be three directions");
  Eigen::Matrix3d axes;
  for (std::size_t i = 0; i < 3; ++i) {
    const Result<Eigen::Vector3d> axis =
        triple_in(json[i], fmt::format("{}[{}]", name, i), 1 + kAxesSlack);
    if (!axis.ok()) return axis.error();
    axes.row(static_cast<Eigen::Index>(i)) = axis->transpose();
  }
  if (!(axes * axes.transpose()).isIdentity(kAxesSlack))
    return wrong(name + " must be three unit vectors at right angles");
  return axes;
}

Result<EditBox> box_in(const Json& json, const std::string& name) {
  if (!json.is_object() || json.size() != 3 || !json.contains("axes") || !json.contains("low_m") ||
      !json.contains("high_m"))
    return wrong(name + " must have \"axes\", \"low_m\" and \"high_m\", and nothing else");
  const Result<Eigen::Matrix3d> axes = axes_in(json["axes"], name + ".axes");
  if (!axes.ok()) return axes.error();
  const Result<Eigen::Vector3d> low_m = triple_in(json["low_m"], name + ".low_m", kFarthestEdit_m);
  if (!low_m.ok()) return low_m.error();
  const Result<Eigen::Vector3d> high_m =
      triple_in(json["high_m"], name + ".high_m", kFarthestEdit_m);
  if (!high_m.ok()) return high_m.error();
  if (!((*high_m - *low_m).array() >= kThinnest_m).all())
    return wrong(fmt::format("{}.high_m must be above low_m by {:g} or more along each axis", name,
                             kThinnest_m));
  return EditBox{*axes, *low_m, *high_m};
}

Result<ScanEdit> edit_in(const Json& json, const std::string& name) {
  if (!json.is_object() || json.size() != 2 || !json.contains("kind") || !json["kind"].is_string())
    return wrong(name + " must have \"kind\", and \"box\" or \"smaller_than_m\"");
  ScanEdit edit;
  bool is_known = false;
  for (const EditKind kind : kKinds) {
    if (json["kind"] != name_of(kind)) continue;
    edit.kind = kind;
    is_known = true;
  }
  if (!is_known) return wrong(name + ".kind must be keep_inside, remove_inside or remove_floating");
  if (edit.kind == EditKind::kRemoveFloating) {
    const Json size = json.value("smaller_than_m", Json());
    if (!size.is_number() ||
        !(size.get<double>() >= kLeastPart_m && size.get<double>() <= kMostPart_m))
      return wrong(fmt::format("{}.smaller_than_m must be a number, {:g} to {:g}", name,
                               kLeastPart_m, kMostPart_m));
    edit.smaller_than_m = size.get<double>();
    return edit;
  }
  const Result<EditBox> box = box_in(json.value("box", Json()), name + ".box");
  if (!box.ok()) return box.error();
  edit.box = *box;
  return edit;
}

Json triple_json(const Eigen::Vector3d& triple) {
  return Json::array({triple.x(), triple.y(), triple.z()});
}

Json edit_json(const ScanEdit& edit) {
  Json json = {{"kind", name_of(edit.kind)}};
  if (edit.kind == EditKind::kRemoveFloating) {
    json["smaller_than_m"] = edit.smaller_than_m;
    return json;
  }
  Json axes = Json::array();
  for (Eigen::Index i = 0; i < 3; ++i) axes.push_back(triple_json(edit.box.axes.row(i)));
  json["box"] = {{"axes", axes},
                 {"low_m", triple_json(edit.box.low_m)},
                 {"high_m", triple_json(edit.box.high_m)}};
  return json;
}

}  // namespace

const char* name_of(EditKind kind) {
  switch (kind) {
    case EditKind::kKeepInside: return "keep_inside";
    case EditKind::kRemoveInside: return "remove_inside";
    case EditKind::kRemoveFloating: return "remove_floating";
  }
  return "";
}

Result<ScanEdits> parse_scan_edits(const std::string& text) {
  const Json json = Json::parse(text, nullptr, false);
  if (!json.is_object() || json.size() != 2 || !json.contains("version") ||
      !json.contains("edits") || !json["edits"].is_array())
    return wrong(
        "the edits must be a JSON object with \"version\" and the list \"edits\", and nothing "
        "else");
  const Json& version = json["version"];
  if (!version.is_number_integer() || version.get<std::int64_t>() < 0)
    return wrong("version must be a whole number from 0");
  if (json["edits"].size() > kMostEdits)
    return wrong(fmt::format("edits has {} entries, at most {} are allowed", json["edits"].size(),
                             kMostEdits));
  ScanEdits edits{version.get<std::int64_t>(), {}};
  for (std::size_t i = 0; i < json["edits"].size(); ++i) {
    const Result<ScanEdit> edit = edit_in(json["edits"][i], fmt::format("edits[{}]", i));
    if (!edit.ok()) return edit.error();
    edits.edits.push_back(*edit);
  }
  return edits;
}

std::string format_scan_edits(const ScanEdits& edits) {
  Json json = {{"version", edits.version}, {"edits", Json::array()}};
  for (const ScanEdit& edit : edits.edits) json["edits"].push_back(edit_json(edit));
  return json.dump();
}

}  // namespace hermite::edit
