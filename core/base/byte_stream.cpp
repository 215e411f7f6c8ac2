#include "core/base/byte_stream.h"

#include <fmt/core.h>

#include <cstring>

namespace hermite {

void ByteWriter::flags(const std::vector<bool>& values) {
  number(std::uint64_t{values.size()});
  std::vector<std::uint8_t> packed((values.size() + 7) / 8, 0);
  for (std::size_t i = 0; i < values.size(); ++i)
    packed[i / 8] = static_cast<std::uint8_t>(packed[i / 8] | (values[i] ? 1 << i % 8 : 0));
  numbers(packed.data(), packed.size());
}

void ByteWriter::text(std::string_view text) {
  number(std::uint64_t{text.size()});
  bytes_.append(text);
}

void ByteReader::copy(void* to, std::size_t count) {
  if (count == 0) return;
  if (count > rest_.size()) require(false, "cut");
  if (!ok()) {
    std::memset(to, 0, count);
    return;
  }
  std::memcpy(to, rest_.data(), count);
  rest_.remove_prefix(count);
}

// Returns the number of items that follow, each of at least `bytes_each` bytes.
std::size_t ByteReader::count_of(std::size_t bytes_each) {
  std::uint64_t count = 0;
  number(count);
  if (count > rest_.size() / bytes_each) require(false, "a count of more than there is");
  return ok() ? static_cast<std::size_t>(count) : 0;
}

void ByteReader::flag(bool& value) {
  std::uint8_t byte = 0;
  number(byte);
  require(byte <= 1, "neither yes nor no");
  value = ok() && byte == 1;
}

void ByteReader::flags(std::vector<bool>& values) {
  std::uint64_t count = 0;
  number(count);
  if (count / 8 > rest_.size()) require(false, "a count of more than there is");
  std::vector<std::uint8_t> packed(ok() ? static_cast<std::size_t>((count + 7) / 8) : 0);
  numbers(packed.data(), packed.size());
  values.assign(ok() ? static_cast<std::size_t>(count) : 0, false);
  for (std::size_t i = 0; i < values.size(); ++i) values[i] = (packed[i / 8] >> i % 8 & 1) != 0;
}

void ByteReader::text(std::string& text) {
  text.resize(count_of(1));
  copy(text.data(), text.size());
}

void ByteReader::require(bool right, const char* message) {
  if (right || !ok()) return;
  wrong_ = fmt::format("at byte {}: {}", size_ - rest_.size(), message);
}

Status ByteReader::status() const {
  if (ok()) return Done{};
  return Error{ErrorCode::kCorruptData, wrong_};
}

}  // namespace hermite
