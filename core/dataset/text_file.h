// Small files of data sets: bytes with a limit, lines with numbers, fields, decimal numbers
// independent of the locale. Pure except for reading files.
#pragma once

#include <cstddef>
#include <cstdint>
#include <optional>
#include <string>
#include <string_view>
#include <vector>

#include "core/base/result.h"

namespace hermite::dataset {

// 100 Hz poses take 800 KiB per hour.
inline constexpr std::size_t kMaxTextFile_bytes = std::size_t{64} << 20;
// An uncompressed 16-bit PNG of the largest camera is 8 MiB.
inline constexpr std::size_t kMaxImageFile_bytes = std::size_t{64} << 20;

// Return false if the system cannot determine it.
bool is_file(const std::string& path);
bool is_folder(const std::string& path);

// Return kNotFound, kIo or kTooLarge, naming the path.
Result<std::vector<std::uint8_t>> read_binary_file(const std::string& path, std::size_t max_bytes);
Result<std::string> read_text_file(const std::string& path,
                                   std::size_t max_bytes = kMaxTextFile_bytes);

struct TextLine {
  int number = 0;  // 1 is the first line of the file
  std::string_view text;
};

// Returns the lines that are neither empty nor comments (starting with '#'), without line ends.
// Views into `text`.
std::vector<TextLine> data_lines(std::string_view text);

// Returns the fields between blanks, tabs and commas (TUM files use either). Views into `line`.
std::vector<std::string_view> split_fields(std::string_view line);

// Returns the whole text as a finite decimal number; std::nullopt otherwise.
std::optional<double> parse_finite(std::string_view text);

// Returns the whole text, consisting of digits, as a number; std::nullopt otherwise, or if it does
// not fit.
std::optional<std::int64_t> parse_index(std::string_view text);

// Returns kCorruptData: "<what>, line <number>: <message>: \"<text>\"", with the text cut to a
// readable length.
Error line_error(const std::string& what, const TextLine& line, const std::string& message);

}  // namespace hermite::dataset
