#include "core/dataset/text_file.h"

#include <fmt/core.h>

#include <charconv>
#include <cmath>
#include <filesystem>
#include <fstream>

namespace hermite::dataset {
namespace {

// Reads into any contiguous byte container. The size is checked before memory is allocated.
template <class Bytes>
Result<Bytes> read_file(const std::string& path, std::size_t max_bytes) {
  std::error_code failure;
  const auto status = std::filesystem::status(path, failure);
  if (!std::filesystem::exists(status))
    return Error{ErrorCode::kNotFound, "there is no file " + path};
  if (!std::filesystem::is_regular_file(status))
    return Error{ErrorCode::kIo, path + " is not a file"};
  const auto size = std::filesystem::file_size(path, failure);
  if (failure)
    return Error{ErrorCode::kIo, fmt::format("cannot read {}: {}", path, failure.message())};
  if (size > max_bytes)
    return Error{ErrorCode::kTooLarge,
                 fmt::format("{} has {} bytes, allowed are {}", path, size, max_bytes)};
  std::ifstream file(path, std::ios::binary);
  Bytes bytes(static_cast<std::size_t>(size), {});
  file.read(reinterpret_cast<char*>(bytes.data()), static_cast<std::streamsize>(size));
  if (!file) return Error{ErrorCode::kIo, "cannot read " + path};
  return bytes;
}

}  // namespace

bool is_file(const std::string& path) {
  std::error_code failure;
  return std::filesystem::is_regular_file(path, failure);
}

bool is_folder(const std::string& path) {
  std::error_code failure;
  return std::filesystem::is_directory(path, failure);
}

Result<std::vector<std::uint8_t>> read_binary_file(const std::string& path, std::size_t max_bytes) {
  return read_file<std::vector<std::uint8_t>>(path, max_bytes);
}

Result<std::string> read_text_file(const std::string& path, std::size_t max_bytes) {
  return read_file<std::string>(path, max_bytes);
}

std::vector<TextLine> data_lines(std::string_view text) {
  std::vector<TextLine> lines;
  int number = 0;
  while (!text.empty()) {
    const std::size_t end = std::min(text.find('\n'), text.size());
    std::string_view line = text.substr(0, end);
    text.remove_prefix(std::min(end + 1, text.size()));
    ++number;
    const std::size_t first = line.find_first_not_of(" \t\r");
    if (first == std::string_view::npos || line[first] == '#') continue;
    line.remove_prefix(first);
    line = line.substr(0, line.find_last_not_of(" \t\r") + 1);
    lines.push_back({number, line});
  }
  return lines;
}

std::vector<std::string_view> split_fields(std::string_view line) {
  constexpr std::string_view kBetween = " \t,\r";
  std::vector<std::string_view> fields;
  for (std::size_t begin = line.find_first_not_of(kBetween); begin != std::string_view::npos;) {
    const std::size_t end = std::min(line.find_first_of(kBetween, begin), line.size());
    fields.push_back(line.substr(begin, end - begin));
    begin = line.find_first_not_of(kBetween, end);
  }
  return fields;
}

std::optional<double> parse_finite(std::string_view text) {
  double value = 0;
  const auto [end, error] = std::from_chars(text.data(), text.data() + text.size(), value);
  if (text.empty() || error != std::errc() || end != text.data() + text.size() ||
      !std::isfinite(value))
    return std::nullopt;
  return value;
}

std::optional<std::int64_t> parse_index(std::string_view text) {
  if (text.empty() || text.find_first_not_of("0123456789") != std::string_view::npos)
    return std::nullopt;
  std::int64_t value = 0;
  const auto [end, error] = std::from_chars(text.data(), text.data() + text.size(), value);
  if (error != std::errc() || end != text.data() + text.size()) return std::nullopt;
  return value;
}

Error line_error(const std::string& what, const TextLine& line, const std::string& message) {
  constexpr std::size_t kReadable = 120;
  const std::string shown(line.text.substr(0, kReadable));
  return {ErrorCode::kCorruptData,
          fmt::format("{}, line {}: {}: \"{}{}\"", what, line.number, message, shown,
                      line.text.size() > kReadable ? "..." : "")};
}

}  // namespace hermite::dataset
