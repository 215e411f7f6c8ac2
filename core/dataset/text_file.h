// Small files of data sets: bytes with a limit, lines with numbers, fields, decimal numbers independent of the locale. Pure but for the
// reads.
#pragma once

#include <cstddef>
#include <cstdint>
#include <optional>
#include <string>
#include <string_view>
#include <vector>

#include "core/base/result.h"

namespace hermite {

inline constexpr std::size_t kMaxTextFile_bytes = std::size_t{64} << 20;   // a day of 100 Hz poses is 800 KiB an hour
inline constexpr std::size_t kMaxImageFile_bytes = std::size_t{64} << 20;  // an uncompressed 16-bit PNG of the largest camera is 8 MiB

// False where the system cannot tell.
bool is_file(const std::string& path);
bool is_folder(const std::string& path);

// kNotFound, kIo or kTooLarge, naming the path.
Result<std::vector<std::uint8_t>> read_binary_file(const std::string& path, std::size_t max_bytes);
Result<std::string> read_text_file(const std::string& path, std::size_t max_bytes = kMaxTextFile_bytes);

struct TextLine {
  int number = 0;  // 1 is the first line of the file
  std::string_view text;
};

// Lines that are neither empty nor comments ('#' first), without their line ends. Views into `text`.
std::vector<TextLine> data_lines(std::string_view text);

// Fields between blanks, tabs and commas (TUM files use either). Views into `line`.
std::vector<std::string_view> split_fields(std::string_view line);

// The whole text as a finite decimal number; nothing otherwise.
std::optional<double> parse_finite(std::string_view text);

// The whole text as digits; nothing otherwise, or when it does not fit.
std::optional<std::int64_t> parse_index(std::string_view text);

// kCorruptData: "<what>, line <number>: <words>: \"<text>\"", the text cut to a readable length.
Error line_error(const std::string& what, const TextLine& line, const std::string& words);

}  // namespace hermite
