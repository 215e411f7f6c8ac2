// hermite_changes: compares two scans of synthetic rooms and judges each place by the rooms' formulas. Prints one JSON object.
#include <CLI/CLI.hpp>
#include <iostream>
#include <nlohmann/json.hpp>

#include "core/compare/compare.h"
#include "core/dataset/sequence.h"
#include "core/dataset/synthetic_camera.h"
#include "core/dataset/text_file.h"
#include "core/evaluate/trajectory_error.h"
#include "core/output/ply_reader.h"

namespace hermite {

namespace {

using Eigen::Vector3d;
using Json = nlohmann::ordered_json;

// A place changed if the other room's surface is at least this far from it, and stayed if it is at most half as far: in
// between, either answer is accepted.
constexpr double kChanged_m = 0.010, kStayed_m = 0.005;
constexpr std::size_t kMostFile_bytes = std::size_t{4} << 30;

struct Scan {
  std::string result, source;
};

SyntheticRoom room_of(const std::string& source) {
  const std::string base = source_without_suffixes(source), prefix = "synthetic:";
  const SyntheticOptions options = or_throw(parse_synthetic_options(base.starts_with(prefix) ? base.substr(prefix.size()) : ""));
  return or_throw(SyntheticRoom::create(options.scene, options.changes));
}

ComparedScan read(const Scan& scan) {
  const Cloud cloud = cloud_of(or_throw(parse_ply(or_throw(read_text_file(scan.result + "/surfels.ply", kMostFile_bytes)))));
  return or_throw(ComparedScan::create(cloud, or_throw(read_tum_trajectory(scan.result + "/trajectory.txt")), scan.result));
}

Rigid3 room_from_scan(const Scan& scan) {
  const Trajectory estimate = or_throw(read_tum_trajectory(scan.result + "/trajectory.txt"));
  return or_throw(trajectory_error(estimate, or_throw(open_sequence(scan.source))->groundtruth())).groundtruth_from_estimate;
}

// Brings a point to the nearest surface of a room: the scan's own error is no change.
Vector3d on_surface(const SyntheticRoom& room, Vector3d point) {
  constexpr double kStep_m = 1e-4;
  for (int step = 0; step < 3; ++step) {
    const double distance_m = room.surface_distance(point);
    Vector3d gradient;
    for (int axis = 0; axis < 3; ++axis)
      gradient[axis] =
          (room.surface_distance(point + kStep_m * Vector3d::Unit(axis)) - room.surface_distance(point - kStep_m * Vector3d::Unit(axis))) /
          (2 * kStep_m);
    if (distance_m < kStep_m || gradient.norm() < 0.1) break;
    point -= distance_m * gradient.normalized();
  }
  return point;
}

struct Counts {
  std::int64_t found = 0, missed = 0, false_alarms = 0, unseen = 0;
  std::int64_t regions = 0, false_regions = 0;
};

// Both rooms have one world.
struct Truth {
  const SyntheticRoom &own, &other;
  Rigid3 room_from_a;

  double change_m(const SurfaceSample& sample) const { return other.surface_distance(on_surface(own, room_from_a * sample.position_m)); }
};

bool is_to_be_found(const ComparedPlace& place, bool of_a) { return of_a || !place.distance_m; }

void count_places(const Comparison& comparison, bool of_a, const Truth& truth, Counts& counts) {
  const ComparedSurface& surface = of_a ? comparison.surface_a : comparison.surface_b;
  std::vector<double> changes_m;
  for (const ComparedPlace& place : surface.places) changes_m.push_back(truth.change_m(place.sample));
  std::vector<bool> is_reported(surface.places.size());
  const std::size_t first = of_a ? 0 : comparison.regions_of_a, last = of_a ? comparison.regions_of_a : comparison.regions.size();
  for (std::size_t i = first; i < last; ++i) {
    std::size_t stayed = 0;
    for (const std::uint32_t place : comparison.regions[i].places) {
      is_reported[place] = true;
      stayed += changes_m[place] <= kStayed_m ? 1 : 0;
    }
    ++counts.regions;
    counts.false_regions += 2 * stayed > comparison.regions[i].places.size() ? 1 : 0;
  }
  for (std::size_t i = 0; i < surface.places.size(); ++i) {
    const bool has_changed = changes_m[i] >= kChanged_m;
    if (is_reported[i] && has_changed) ++counts.found;
    if (is_reported[i] && changes_m[i] <= kStayed_m) ++counts.false_alarms;
    if (is_reported[i] || !has_changed || !is_to_be_found(surface.places[i], of_a)) continue;
    ++(surface.places[i].state == PlaceState::kUnseen ? counts.unseen : counts.missed);
  }
}

Json judged(const Scan& a, const Scan& b) {
  const ComparedScan scan_a = read(a), scan_b = read(b);
  const Comparison comparison = or_throw(compare_scans(scan_a, scan_b, ChangeOptions()));
  Json json{{"verdict", name_of(comparison.registration.verdict)}, {"words", comparison.registration.words}};
  if (comparison.registration.verdict != RegistrationVerdict::kSamePlace) return json;
  const SyntheticRoom room_a = room_of(a.source), room_b = room_of(b.source);
  const Rigid3 room_from_a = room_from_scan(a), true_a_from_b = inverse(room_from_a) * room_from_scan(b);
  Counts counts;
  count_places(comparison, true, {room_a, room_b, room_from_a}, counts);
  count_places(comparison, false, {room_b, room_a, room_from_a}, counts);
  const ScanAlignment& alignment = comparison.registration.alignment;
  const Rigid3 error = alignment.a_from_b * inverse(true_a_from_b);
  json["position_error_m"] = (error * alignment.middle_m - alignment.middle_m).norm();
  json["turn_error_deg"] = angle_rad(error.rotation) * 180 / M_PI;
  json["disagreement_m"] = alignment.disagreement_m;
  json["compared_area_m2"] = comparison.compared_area_m2;
  json["places_found"] = counts.found;
  json["places_missed"] = counts.missed;
  json["places_false"] = counts.false_alarms;
  json["places_unseen"] = counts.unseen;
  json["regions"] = counts.regions;
  json["regions_false"] = counts.false_regions;
  return json;
}

int run(int argc, char** argv) {
  CLI::App app{"Judges the comparison of two scans of synthetic rooms"};
  Scan a, b;
  app.add_option("--a", a.result, "Result of the first scan")->required();
  app.add_option("--a-source", a.source, "synthetic:... of which it was made")->required();
  app.add_option("--b", b.result, "Result of the second scan")->required();
  app.add_option("--b-source", b.source, "synthetic:... of which it was made")->required();
  CLI11_PARSE(app, argc, argv);
  std::cout << judged(a, b).dump(2) << "\n";
  return 0;
}

}  // namespace

}  // namespace hermite

int main(int argc, char** argv) {
  try {
    return hermite::run(argc, argv);
  } catch (const std::exception& error) {
    std::cerr << "hermite_changes: " << error.what() << "\n";
    return 1;
  }
}
