// hermite_changes: compares two scans of synthetic rooms and judges each place by the rooms'
// formulas. Prints one JSON object.
#include <CLI/CLI.hpp>
#include <Eigen/Cholesky>
#include <iostream>
#include <nlohmann/json.hpp>
#include <optional>

#include "core/base/parallel.h"
#include "core/compare/compare.h"
#include "core/dataset/text_file.h"
#include "core/evaluate/trajectory_error.h"
#include "core/output/ply_reader.h"
#include "core/source/open_sequence.h"
#include "core/synthetic/room_light.h"
#include "core/synthetic/synthetic_camera.h"
#include "tests/accuracy/program/guarded_main.h"

namespace hermite {

namespace {

using Eigen::Vector3d;
using Json = nlohmann::ordered_json;

// A place changed if the other room's surface is at least this far from it, and stayed if it is at
// most half as far: in between, either answer is accepted.
constexpr double kChanged_m = 0.0099, kStayed_m = 0.0051;
constexpr double kEither_m = (kChanged_m + kStayed_m) / 2;  // also said of places on edges
constexpr std::size_t kMostFile_bytes = std::size_t{4} << 30;

struct Scan {
  std::string result, source;
};

synthetic::Furniture room_of(const std::string& source) {
  const std::string base = source::source_without_suffixes(source), prefix = "synthetic:";
  const synthetic::SyntheticOptions options = or_throw(synthetic::parse_synthetic_options(
      base.starts_with(prefix) ? base.substr(prefix.size()) : ""));
  synthetic::Furniture room = synthetic::furnish(options.scene);
  or_throw(synthetic::apply_changes(options.changes, room));
  return room;
}

compare::ComparedScan read(const Scan& scan) {
  const output::Cloud cloud = output::cloud_of(or_throw(output::parse_ply(
      or_throw(dataset::read_text_file(scan.result + "/surfels.ply", kMostFile_bytes)))));
  return or_throw(compare::ComparedScan::create(
      cloud, or_throw(dataset::read_tum_trajectory(scan.result + "/trajectory.txt")), scan.result));
}

Rigid3 room_from_scan(const Scan& scan) {
  const dataset::Trajectory estimate =
      or_throw(dataset::read_tum_trajectory(scan.result + "/trajectory.txt"));
  return or_throw(evaluate::trajectory_error(
                      estimate, or_throw(source::open_sequence(scan.source))->groundtruth()))
      .groundtruth_from_estimate;
}

// The direction in which the signed distance to a room's surface grows: that surface's normal,
// towards free space.
Vector3d normal_of(const synthetic::Furniture& room, const Vector3d& point) {
  constexpr double kStep_m = 1e-5;
  Vector3d gradient;
  for (int axis = 0; axis < 3; ++axis) {
    const Vector3d step = kStep_m * Vector3d::Unit(axis);
    gradient[axis] = synthetic::signed_distance(room, point + step) -
                     synthetic::signed_distance(room, point - step);
  }
  return gradient.norm() < 0.2 * kStep_m ? Vector3d(Vector3d::Zero()) : gradient.normalized();
}

// Brings a point to the nearest surface of a room: the scan's own error is no change.
Vector3d on_surface(const synthetic::Furniture& room, Vector3d point) {
  for (int step = 0; step < 3; ++step)
    point -= synthetic::signed_distance(room, point) * normal_of(room, point);
  return point;
}

// Where a line enters a room's bodies against its direction, nearest to its origin; the reach if it
// does not.
double crossing_m(const synthetic::Furniture& room, const Vector3d& origin,
                  const Vector3d& direction) {
  constexpr double kStep_m = 0.001;
  for (int step = 0; step * kStep_m < compare::kSheetReach_m; ++step)
    for (const double side : {1.0, -1.0}) {
      const Vector3d at = origin + side * step * kStep_m * direction;
      if (synthetic::signed_distance(room, at) <= 0 &&
          synthetic::signed_distance(room, at + kStep_m * direction) > 0)
        return step * kStep_m;
    }
  return compare::kSheetReach_m;
}

// How far the other room's surface is from a point of the own one's: its nearest surface if that
// faces the same way. The back of a thin thing that moved is not where its front was, so otherwise
// the way along the normal counts.
double change_between(const synthetic::Furniture& other, const Vector3d& point,
                      const Vector3d& normal) {
  const double distance_m = synthetic::signed_distance(other, point);
  if (normal_of(other, point).dot(normal) > compare::kSheetCosine) return std::abs(distance_m);
  const double along_m = crossing_m(other, point, normal);
  return along_m < compare::kSheetReach_m ? along_m : std::abs(distance_m);
}

// A path of some metres tells the turn of the world to a tenth of a degree, the surface tells it
// better.
Rigid3 refined_by_surface(const synthetic::Furniture& room, const compare::ComparedScan& scan,
                          Rigid3 room_from_scan) {
  constexpr double kOutlier_m = 0.01;
  const compare::SurfaceSamples samples = compare::surface_samples(scan.surfels(), 0.1, 10'000);
  for (int round = 0; round < 5; ++round) {
    Matrix6d information = Matrix6d::Zero();
    Vector6d right = Vector6d::Zero();
    for (const compare::SurfaceSample& sample : samples.samples) {
      const Vector3d point = room_from_scan * sample.position_m;
      const double distance_m = synthetic::signed_distance(room, point);
      if (std::abs(distance_m) > kOutlier_m) continue;
      Vector6d row;
      const Vector3d normal = normal_of(room, point);
      row << normal, point.cross(normal);
      information += row * row.transpose();
      right -= distance_m * row;
    }
    room_from_scan = exp_se3(information.ldlt().solve(right)) * room_from_scan;
  }
  return room_from_scan;
}

struct Counts {
  std::int64_t found = 0, missed = 0, false_alarms = 0, unseen = 0;
  std::int64_t regions = 0, false_regions = 0;
};

// Both rooms have one world.
struct Truth {
  const synthetic::Furniture &own, &other;
  Rigid3 room_from_a;

  // nullopt for a place that lies on an edge, whose normal is not its surface's.
  std::optional<double> change_m(const compare::SurfaceSample& sample) const {
    const Vector3d point = on_surface(own, room_from_a * sample.position_m),
                   normal = room_from_a.rotation * sample.normal;
    const Vector3d true_normal = normal_of(own, point + kOffSurface_m * normal);
    if (true_normal.dot(normal) < kEdgeCosine) return std::nullopt;
    return change_between(other, point, true_normal);
  }

 private:
  static constexpr double kOffSurface_m = 0.0005, kEdgeCosine = 0.8;
};

bool is_to_be_found(const compare::ComparedPlace& place, bool of_a) {
  return of_a || !place.distance_m;
}

void count_places(const compare::Comparison& comparison, bool of_a, const Truth& truth,
                  Counts& counts) {
  const compare::ComparedSurface& surface = of_a ? comparison.surface_a : comparison.surface_b;
  std::vector<double> changes_m(surface.places.size());
  in_parallel(changes_m.size(), [&](std::size_t i) {
    changes_m[i] = truth.change_m(surface.places[i].sample).value_or(kEither_m);
  });
  std::vector<bool> is_reported(surface.places.size());
  const std::size_t first = of_a ? 0 : comparison.regions_of_a,
                    last = of_a ? comparison.regions_of_a : comparison.regions.size();
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
    ++(surface.places[i].state == compare::PlaceState::kUnseen ? counts.unseen : counts.missed);
  }
}

Json judged(const Scan& a, const Scan& b) {
  const compare::ComparedScan scan_a = read(a), scan_b = read(b);
  const compare::Comparison comparison =
      or_throw(compare::compare_scans(scan_a, scan_b, compare::ChangeOptions()));
  Json json{{"verdict", name_of(comparison.registration.verdict)},
            {"words", comparison.registration.message}};
  if (comparison.registration.verdict != compare::RegistrationVerdict::kSamePlace) return json;
  const synthetic::Furniture room_a = room_of(a.source), room_b = room_of(b.source);
  const Rigid3 room_from_a = refined_by_surface(room_a, scan_a, room_from_scan(a)),
               room_from_b = refined_by_surface(room_b, scan_b, room_from_scan(b)),
               true_a_from_b = inverse(room_from_a) * room_from_b;
  Counts counts;
  count_places(comparison, true, {room_a, room_b, room_from_a}, counts);
  count_places(comparison, false, {room_b, room_a, room_from_a}, counts);
  const compare::ScanAlignment& alignment = comparison.registration.alignment;
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
  return hermite::guarded_main("hermite_changes", [&] { return hermite::run(argc, argv); });
}
