#include "core/adjust/features.h"

#include <algorithm>
#include <array>
#include <cmath>
#include <cstring>
#include <opencv2/features2d.hpp>
#include <opencv2/imgproc.hpp>

#include "core/adjust/bundle_noise.h"
#include "core/base/check.h"

namespace hermite::adjust {
namespace {

// A corner's score is the largest threshold at which it is still detected. Corners of the strict
// threshold are repeatable; in a cell without any, the lenient one still finds some (thresholds of
// ORB-SLAM and of the authors' program).
constexpr int kStrictThreshold = 20;
constexpr int kLenientThreshold = 7;
// Radius of the patch that gives the orientation; also half the side of the descriptor's patch.
constexpr int kPatchRadius_px = 15;
// Keeps the descriptor's tests inside the image in every orientation.
constexpr int kBorder_px = 19;
constexpr int kFastRadius_px = 3;      // of the circle of the FAST corner test
constexpr int kLeastInnerSide_px = 8;  // smaller octaves are not searched
constexpr double kReferenceArea_px = 640.0 * 480.0;

struct Corner {
  int x, y;  // in the octave's image
  int score;
};

// Returns the lenient corners of one octave, row by row.
std::vector<Corner> find_corners(const cv::Mat& image) {
  const int margin = kBorder_px - kFastRadius_px;
  const cv::Mat inner =
      image(cv::Rect(margin, margin, image.cols - 2 * margin, image.rows - 2 * margin));
  std::vector<cv::KeyPoint> points;
  cv::FAST(inner, points, kLenientThreshold, true, cv::FastFeatureDetector::TYPE_9_16);
  std::vector<Corner> corners;
  corners.reserve(points.size());
  for (const cv::KeyPoint& point : points)
    corners.push_back(
        {cvRound(point.pt.x) + margin, cvRound(point.pt.y) + margin, cvRound(point.response)});
  return corners;
}

// Orders stronger corners first; equal ones by position, so that the order is unique.
bool precedes(const Corner& a, const Corner& b) {
  if (a.score != b.score) return a.score > b.score;
  return a.y != b.y ? a.y < b.y : a.x < b.x;
}

// Divides the image into as many cells as corners are wanted and takes the strongest corner of
// every cell first, then the second strongest and so on, so that one textured region does not use
// up the count. Returns them in the order of cells.
std::vector<Corner> spread(const std::vector<Corner>& corners, const cv::Size& size,
                           std::size_t wanted) {
  const double inner_area =
      static_cast<double>(size.width - 2 * kBorder_px) * (size.height - 2 * kBorder_px);
  const double side_px = std::max(1.0, std::sqrt(inner_area / static_cast<double>(wanted)));
  const auto cell_of = [&](int coordinate) {
    return static_cast<std::size_t>((coordinate - kBorder_px) / side_px);
  };
  const std::size_t columns = cell_of(size.width - kBorder_px) + 1,
                    rows = cell_of(size.height - kBorder_px) + 1;
  std::vector<std::vector<Corner>> cells(columns * rows);
  for (const Corner& corner : corners)
    cells[cell_of(corner.y) * columns + cell_of(corner.x)].push_back(corner);

  std::vector<std::size_t> taken(cells.size(), 0);
  for (auto& cell : cells) {
    std::sort(cell.begin(), cell.end(), precedes);
    if (!cell.empty() && cell.front().score >= kStrictThreshold)
      while (cell.back().score < kStrictThreshold) cell.pop_back();
  }
  std::size_t count = 0;
  for (std::size_t rank = 0; count < wanted; ++rank) {
    std::vector<std::size_t> offering;
    for (std::size_t i = 0; i < cells.size(); ++i)
      if (cells[i].size() > rank) offering.push_back(i);
    if (offering.empty()) break;
    if (offering.size() > wanted - count) {
      std::sort(offering.begin(), offering.end(), [&](std::size_t a, std::size_t b) {
        return precedes(cells[a][rank], cells[b][rank]);
      });
      offering.resize(wanted - count);
    }
    for (const std::size_t i : offering) taken[i] = rank + 1;
    count += offering.size();
  }
  std::vector<Corner> chosen;
  chosen.reserve(count);
  for (std::size_t i = 0; i < cells.size(); ++i)
    chosen.insert(chosen.end(), cells[i].begin(),
                  cells[i].begin() + static_cast<std::ptrdiff_t>(taken[i]));
  return chosen;
}

// Returns half the width of the patch's disc, by row.
std::array<int, kPatchRadius_px + 1> disc_half_widths() {
  std::array<int, kPatchRadius_px + 1> widths{};
  for (int y = 0; y <= kPatchRadius_px; ++y)
    widths[static_cast<std::size_t>(y)] =
        static_cast<int>(std::sqrt(static_cast<double>(kPatchRadius_px * kPatchRadius_px - y * y)));
  return widths;
}

// Returns the direction from the corner to the intensity centroid of the disc around it (Rublee et
// al. 2011, Eq. 1 to 3).
float orientation_rad(const cv::Mat& image, const Corner& corner) {
  static const std::array<int, kPatchRadius_px + 1> half_widths = disc_half_widths();
  int moment_x = 0, moment_y = 0;
  for (int dy = -kPatchRadius_px; dy <= kPatchRadius_px; ++dy) {
    const std::uint8_t* row = image.ptr<std::uint8_t>(corner.y + dy) + corner.x;
    const int half_width = half_widths[static_cast<std::size_t>(std::abs(dy))];
    int sum = 0;
    for (int dx = -half_width; dx <= half_width; ++dx) {
      moment_x += dx * row[dx];
      sum += row[dx];
    }
    moment_y += dy * sum;
  }
  return std::atan2(static_cast<float>(moment_y), static_cast<float>(moment_x));
}

// OpenCV gets each octave's image as a pyramid of one level, so that its ORB does not build our
// pyramid again.
std::vector<Descriptor> describe(const cv::Mat& image, const std::vector<Corner>& corners,
                                 const std::vector<float>& angles_rad) {
  std::vector<cv::KeyPoint> points;
  points.reserve(corners.size());
  for (std::size_t i = 0; i < corners.size(); ++i)
    points.emplace_back(static_cast<float>(corners[i].x), static_cast<float>(corners[i].y),
                        2.0f * kPatchRadius_px + 1, angles_rad[i] * static_cast<float>(180 / M_PI),
                        0.0f, 0);
  const cv::Ptr<cv::ORB> orb =
      cv::ORB::create(kMaxFeatureCount, static_cast<float>(kOctaveScale), 1, kBorder_px);
  cv::Mat rows;
  orb->compute(image, points, rows);
  CHECK(points.size() == corners.size() && static_cast<std::size_t>(rows.rows) == corners.size(),
        "ORB dropped corners inside the border");
  std::vector<Descriptor> descriptors(corners.size());
  static_assert(sizeof(Descriptor) == kDescriptorBits / 8);
  for (std::size_t i = 0; i < corners.size(); ++i)
    std::memcpy(&descriptors[i], rows.ptr(static_cast<int>(i)), sizeof(Descriptor));
  return descriptors;
}

std::size_t wanted_count(const Camera& camera, const FeatureOptions& options) {
  const double wanted = options.feature_count * std::sqrt(static_cast<double>(camera.width) *
                                                          camera.height / kReferenceArea_px);
  return static_cast<std::size_t>(std::clamp(wanted, 1.0, static_cast<double>(kMaxFeatureCount)));
}

// Returns this octave's share of the features still wanted, in proportion to the side lengths of
// the octaves.
std::size_t share(std::size_t wanted, int octave) {
  const double ratio = 1 / kOctaveScale;
  const double part = (1 - ratio) / (1 - std::pow(ratio, kOctaveCount - octave));
  return std::min(wanted, static_cast<std::size_t>(std::ceil(static_cast<double>(wanted) * part)));
}

struct Octave {
  cv::Mat image;
  int index = 0;
};

// Appends at most `wanted` features.
void append_octave(const Octave& octave, std::size_t wanted, const frame::RgbdFrame& frame,
                   const Camera& camera, std::vector<Feature>& features) {
  const cv::Mat& image = octave.image;
  const std::vector<Corner> corners = spread(find_corners(image), image.size(), wanted);
  if (corners.empty()) return;
  std::vector<float> angles_rad;
  angles_rad.reserve(corners.size());
  for (const Corner& corner : corners) angles_rad.push_back(orientation_rad(image, corner));
  const std::vector<Descriptor> descriptors = describe(image, corners, angles_rad);
  // Position of a scaled pixel's centre in the full image. Image sizes are integers, so the scale
  // is not exactly 1.2^octave.
  const Eigen::Vector2d scale(static_cast<double>(camera.width) / image.cols,
                              static_cast<double>(camera.height) / image.rows);
  for (std::size_t i = 0; i < corners.size(); ++i) {
    const Eigen::Vector2d pixel_px =
        (Eigen::Array2d(corners[i].x, corners[i].y) + 0.5) * scale.array() - 0.5;
    features.push_back({pixel_px.cast<float>(),
                        depth_at(frame.depth, camera, pixel_px.cast<float>()),
                        static_cast<std::uint8_t>(octave.index), angles_rad[i], descriptors[i]});
  }
}

}  // namespace

double octave_scale(int octave) { return std::pow(kOctaveScale, octave); }

float depth_at(const DepthImage& depth, const Camera& camera, const Eigen::Vector2f& pixel_px) {
  // Least number of pixels with depth, of nine; holes are rare on a smooth surface, but half of the
  // window at its boundary.
  constexpr int kLeastCount = 5;
  if (!(pixel_px.array() >= 0).all() || !(pixel_px.x() <= static_cast<float>(depth.width - 1)) ||
      !(pixel_px.y() <= static_cast<float>(depth.height - 1)))
    return 0;
  const int x = static_cast<int>(std::lround(pixel_px.x())),
            y = static_cast<int>(std::lround(pixel_px.y()));
  std::array<std::uint16_t, 9> values{};
  int count = 0;
  for (int v = std::max(0, y - 1); v <= std::min(depth.height - 1, y + 1); ++v)
    for (int u = std::max(0, x - 1); u <= std::min(depth.width - 1, x + 1); ++u)
      if (depth.at(u, v) != 0) values[static_cast<std::size_t>(count++)] = depth.at(u, v);
  if (count < kLeastCount) return 0;
  std::sort(values.begin(), values.begin() + count);
  const double depth_m = values[static_cast<std::size_t>(count / 2)] / camera.depth_units_per_metre;
  const double span_m =
      (values[static_cast<std::size_t>(count - 1)] - values[0]) / camera.depth_units_per_metre;
  // The spread of noise, plus two pixels of a surface tilted by 60 degrees. Matching tolerates
  // smaller depth steps.
  const double allowed_m =
      3 * depth_deviation_m(depth_m) + 2 * depth_m / camera.fx * std::tan(M_PI / 3);
  if (span_m > allowed_m || depth_m < kMinFeatureDepth_m || depth_m > kMaxFeatureDepth_m) return 0;
  return static_cast<float>(depth_m);
}

std::vector<Feature> detect_features(const frame::RgbdFrame& frame, const Camera& camera,
                                     const FeatureOptions& options) {
  CHECK(frame.color.width == camera.width && frame.color.height == camera.height,
        "the colour image must have the camera's size");
  CHECK(frame.depth.width == camera.width && frame.depth.height == camera.height,
        "the depth image must have the camera's size");
  // Only read.
  const cv::Mat rgb(camera.height, camera.width, CV_8UC3,
                    const_cast<Rgb8*>(frame.color.pixels.data()));
  cv::Mat image;
  cv::cvtColor(rgb, image, cv::COLOR_RGB2GRAY);

  const std::size_t wanted = wanted_count(camera, options);
  std::vector<Feature> features;
  features.reserve(wanted);
  for (int octave = 0; octave < kOctaveCount && features.size() < wanted; ++octave) {
    if (octave > 0) {
      const double scale = octave_scale(octave);
      cv::Mat smaller;
      // INTER_LINEAR_EXACT gives the same bits on every machine.
      cv::resize(image, smaller,
                 cv::Size(cvRound(camera.width / scale), cvRound(camera.height / scale)), 0, 0,
                 cv::INTER_LINEAR_EXACT);
      image = smaller;
    }
    if (std::min(image.cols, image.rows) < 2 * kBorder_px + kLeastInnerSide_px) break;
    append_octave({image, octave}, share(wanted - features.size(), octave), frame, camera,
                  features);
  }
  return features;
}

}  // namespace hermite::adjust
