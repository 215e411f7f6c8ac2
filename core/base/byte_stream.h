// Converts numbers to bytes and back, for formats of this program: data written with a ByteWriter
// is read with a ByteReader by the same calls in the same order. So one function can describe both
// directions:
//
//   template <class Bytes, class Place>  // Place: Thing, or const Thing to be written
//   void fields(Bytes& bytes, Place& place) {
//     bytes.number(place.submap);
//     bytes.numbers(place.pixels_px);
//     bytes.require(place.submap < 10, "the submap of a place");
//   }
//
// Little endian, as in memory; counts have 64 bits. A reader trusts no count: it never allocates
// memory for more data than there are bytes. Its first failure is kept, and everything afterwards
// reads as zero or empty. One thread at a time.
#pragma once

#include <bit>
#include <cstddef>
#include <cstdint>
#include <string>
#include <string_view>
#include <type_traits>
#include <utility>
#include <vector>

#include "core/base/result.h"

namespace hermite {

static_assert(std::endian::native == std::endian::little,
              "numbers are written as they lie in memory");

// Whether a type is a number or a struct of only numbers without padding. bool is excluded, because
// not every byte is a valid one.
template <class Value>
inline constexpr bool kIsPlain = std::is_trivially_copyable_v<Value> &&
                                 !std::is_same_v<Value, bool> && !std::is_pointer_v<Value>;

class ByteWriter {
 public:
  template <class Value>
  void numbers(const Value* values, std::size_t count) {
    static_assert(kIsPlain<Value>);
    bytes_.append(reinterpret_cast<const char*>(values), count * sizeof(Value));
  }
  template <class Value>
  void number(const Value& value) {
    numbers(&value, 1);
  }
  template <class Value>
  void numbers(const std::vector<Value>& values) {
    number(std::uint64_t{values.size()});
    numbers(values.data(), values.size());
  }
  void flag(bool value) { number(static_cast<std::uint8_t>(value ? 1 : 0)); }
  void flags(const std::vector<bool>& values);  // eight per byte
  void text(std::string_view text);
  template <class Item, class Fields>
  void list(const std::vector<Item>& items, Fields fields) {
    number(std::uint64_t{items.size()});
    for (const Item& item : items) fields(*this, item);
  }
  void require(bool, const char*) {}  // does nothing: written data is valid

  std::string take() { return std::move(bytes_); }

 private:
  std::string bytes_;
};

class ByteReader {
 public:
  explicit ByteReader(std::string_view bytes) : rest_(bytes), size_(bytes.size()) {}

  template <class Value>
  void numbers(Value* values, std::size_t count) {
    static_assert(kIsPlain<Value>);
    copy(values, count * sizeof(Value));
  }
  template <class Value>
  void number(Value& value) {
    numbers(&value, 1);
  }
  template <class Value>
  void numbers(std::vector<Value>& values) {
    values.resize(count_of(sizeof(Value)));
    numbers(values.data(), values.size());
  }
  void flag(bool& value);
  void flags(std::vector<bool>& values);
  void text(std::string& text);
  // Each item has at least one byte.
  template <class Item, class Fields>
  void list(std::vector<Item>& items, Fields fields) {
    items.clear();
    for (std::size_t left = count_of(1); left > 0 && ok(); --left)
      fields(*this, items.emplace_back());
  }

  // Fails unless `right`; `message` names what is wrong then.
  void require(bool right, const char* message);

  bool ok() const { return wrong_.empty(); }
  bool at_end() const { return rest_.empty(); }
  // kCorruptData with a text such as "at byte 1234: cut", or the message of require().
  Status status() const;

 private:
  void copy(void* to, std::size_t count);
  std::size_t count_of(std::size_t bytes_each);

  std::string_view rest_;
  const std::size_t size_;
  std::string wrong_;
};

}  // namespace hermite
