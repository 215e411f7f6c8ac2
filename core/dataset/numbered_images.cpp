#include "core/dataset/numbered_images.h"

#include <fmt/core.h>

#include <algorithm>
#include <array>
#include <cctype>
#include <filesystem>
#include <map>
#include <string_view>

#include "core/dataset/text_file.h"

namespace hermite::dataset {
namespace {

constexpr std::array<std::string_view, 1> kDepthWords = {"depth"};
constexpr std::array<std::string_view, 4> kColorWords = {"color", "colour", "rgb", "image"};
constexpr std::size_t kMaxDigits = 15;  // microseconds of thirty years
constexpr std::size_t kMaxFolders = 1000;

enum class Kind { kNone, kColor, kDepth };

std::string lower(std::string text) {
  for (char& letter : text)
    letter = static_cast<char>(std::tolower(static_cast<unsigned char>(letter)));
  return text;
}

template <std::size_t N>
bool has_word(const std::string& text, const std::array<std::string_view, N>& words) {
  return std::any_of(words.begin(), words.end(),
                     [&](std::string_view word) { return text.find(word) != std::string::npos; });
}

Kind kind_of(const std::string& name) {
  const std::string text = lower(name);
  return has_word(text, kDepthWords)   ? Kind::kDepth
         : has_word(text, kColorWords) ? Kind::kColor
                                       : Kind::kNone;
}

bool has_ending(const std::string& name, Kind kind) {
  const std::string ending = lower(std::filesystem::path(name).extension().string());
  return ending == ".png" || (kind == Kind::kColor && (ending == ".jpg" || ending == ".jpeg"));
}

struct ImageName {
  std::string path;  // relative to the folder
  std::optional<double> time_s;
};
using ImageNames = std::map<std::int64_t, ImageName>;  // by number

std::vector<std::int64_t> digit_runs(std::string_view name) {
  constexpr std::string_view kDigits = "0123456789";
  std::vector<std::int64_t> runs;
  for (std::size_t begin = name.find_first_of(kDigits); begin != std::string_view::npos;) {
    const std::size_t end = std::min(name.find_first_not_of(kDigits, begin), name.size());
    if (end - begin > kMaxDigits) return {};
    runs.push_back(parse_index(name.substr(begin, end - begin)).value_or(0));
    begin = name.find_first_of(kDigits, end);
  }
  return runs;
}

void add_image(const std::string& within, const std::string& name, Kind kind, ImageNames& images) {
  const auto runs = digit_runs(std::filesystem::path(name).stem().string());
  if (runs.empty() || !has_ending(name, kind)) return;
  ImageName image{within + name, std::nullopt};
  if (runs.size() == 2) image.time_s = static_cast<double>(runs[1]) * 1e-6;
  // Of two with the same number, the first in alphabetical order counts.
  images.emplace(runs[0], std::move(image));
}

bool times_ascend(const ImageNames& images) {
  const ImageName* before = nullptr;
  for (const auto& [number, image] : images) {
    if (!image.time_s || (before && *image.time_s <= *before->time_s)) return false;
    before = &image;
  }
  return !images.empty();
}

Result<NumberedImages> pair_images(const ImageNames& colors, const ImageNames& depths,
                                   double frame_rate_hz) {
  NumberedImages found;
  found.has_times = times_ascend(depths);
  if (found.has_times && times_ascend(colors)) {  // there may be two unsynchronised clocks
    std::vector<TimedFile> timed_colors, timed_depths;
    for (const auto& [number, image] : colors) timed_colors.push_back({*image.time_s, image.path});
    for (const auto& [number, image] : depths) timed_depths.push_back({*image.time_s, image.path});
    auto frames = pair_by_time(std::move(timed_colors), std::move(timed_depths));
    if (!frames.ok()) return frames.error();
    found.frames = std::move(*frames);
    return found;
  }
  for (const auto& [number, depth] : depths) {
    const auto color = colors.find(number);
    if (color == colors.end()) continue;
    const double time_s =
        found.has_times ? *depth.time_s : static_cast<double>(number) / frame_rate_hz;
    found.frames.push_back({time_s, color->second.path, depth.path});
  }
  return found;
}

Result<std::vector<std::string>> folder_names(const std::string& folder) {
  std::error_code failure;
  std::vector<std::string> names;
  for (std::filesystem::directory_iterator entries(folder, failure), end;
       !failure && entries != end; entries.increment(failure)) {
    std::error_code ignored;
    if (entries->is_directory(ignored)) names.push_back(entries->path().filename().string());
    if (names.size() > kMaxFolders)
      return Error{ErrorCode::kTooLarge,
                   fmt::format("{} has more than {} folders", folder, kMaxFolders)};
  }
  if (failure)
    return Error{ErrorCode::kIo,
                 fmt::format("cannot list the folder {}: {}", folder, failure.message())};
  std::sort(names.begin(), names.end());
  return names;
}

struct ImageFolders {
  std::string color, depth;  // with a trailing slash
};

// Shorter names first: "depth" before "depth_vis".
ImageFolders image_folders(const std::vector<std::string>& names, const std::string& within) {
  ImageFolders folders;
  std::vector<std::string> by_length = names;
  std::stable_sort(by_length.begin(), by_length.end(),
                   [](const auto& a, const auto& b) { return a.size() < b.size(); });
  for (const std::string& name : by_length) {
    const Kind kind = kind_of(name);
    if (kind == Kind::kDepth && folders.depth.empty()) folders.depth = within + name + "/";
    if (kind == Kind::kColor && folders.color.empty()) folders.color = within + name + "/";
  }
  return folders;
}

Result<NumberedImages> from_two_folders(const std::string& folder, const ImageFolders& folders,
                                        double frame_rate_hz) {
  ImageNames colors, depths;
  for (const auto& [within, kind, images] : {std::tuple{folders.color, Kind::kColor, &colors},
                                             std::tuple{folders.depth, Kind::kDepth, &depths}}) {
    const auto names = file_names(folder + "/" + within);
    if (!names.ok()) return names.error();
    for (const std::string& name : *names) add_image(within, name, kind, *images);
  }
  Result<NumberedImages> found = pair_images(colors, depths, frame_rate_hz);
  if (found.ok()) found->where = fmt::format("{} and {}", folders.color, folders.depth);
  return found;
}

Result<NumberedImages> from_one_folder(const std::string& folder, const std::string& within,
                                       double frame_rate_hz) {
  const auto names = file_names(folder + "/" + within);
  if (!names.ok()) return names.error();
  ImageNames colors, depths;
  for (const std::string& name : *names) {
    const Kind kind = kind_of(name);
    if (kind != Kind::kNone) add_image(within, name, kind, kind == Kind::kDepth ? depths : colors);
  }
  Result<NumberedImages> found = pair_images(colors, depths, frame_rate_hz);
  if (found.ok()) found->where = within.empty() ? "the folder itself" : within;
  return found;
}

Result<std::optional<NumberedImages>> find_within(const std::string& folder,
                                                  const std::string& within, double frame_rate_hz) {
  const auto names = folder_names(folder + "/" + within);
  if (!names.ok()) return names.error();
  const ImageFolders folders = image_folders(*names, within);
  Result<NumberedImages> found = !folders.color.empty() && !folders.depth.empty()
                                     ? from_two_folders(folder, folders, frame_rate_hz)
                                     : from_one_folder(folder, within, frame_rate_hz);
  if (!found.ok()) return found.error();
  if (found->frames.empty()) return std::optional<NumberedImages>();
  return std::optional<NumberedImages>(std::move(*found));
}

}  // namespace

Result<std::optional<NumberedImages>> find_numbered_images(const std::string& folder,
                                                           double frame_rate_hz) {
  if (!is_folder(folder)) return std::optional<NumberedImages>();
  auto found = find_within(folder, "", frame_rate_hz);
  if (!found.ok() || found->has_value()) return found;
  const auto names = folder_names(folder);
  if (!names.ok()) return names.error();
  for (const std::string& name : *names) {
    found = find_within(folder, name + "/", frame_rate_hz);
    if (!found.ok() || found->has_value()) return found;
  }
  return std::optional<NumberedImages>();
}

}  // namespace hermite::dataset
