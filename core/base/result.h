// Failures that are expected: bad bytes, a missing file, a full disk, a device that runs out of memory.
//
//   Result<Image> image = decode_png(bytes, limits);
//   if (!image.ok()) return image.error();
//   use(*image);
//
// Three kinds of failure are never mixed: what is expected is a Result; a set-up that is impossible throws
// SetupError, which is caught once per scan or in main; our own mistake is a CHECK (core/base/check.h).
// Values: thread-compatible, no hidden sharing.
#pragma once

#include <stdexcept>
#include <string>
#include <utility>
#include <variant>

#include "core/base/check.h"

namespace hermite {

enum class ErrorCode {
  kInvalidArgument,  // the caller's value is out of its documented range
  kNotFound,
  kCorruptData,  // bytes that cannot be what they claim to be
  kTooLarge,     // a stated limit would be exceeded
  kUnsupported,  // understood, but not something this build can do
  kIo,           // the operating system said no
  kDevice,       // GPU missing, lost or out of memory
  kUnauthorized,
  kBusy,  // try again later
};

// One word for logs, JSON and the protocol: "corrupt_data".
const char* name_of(ErrorCode code);

struct Error {
  ErrorCode code = ErrorCode::kInvalidArgument;
  std::string message;  // for a person: names the field, the value and the limit
};

// "words: inner message", keeping the code: adds where it happened while an error travels outwards.
Error in_context(const std::string& words, const Error& error);

template <class T>
class [[nodiscard]] Result {
 public:
  Result(T value) : state_(std::move(value)) {}
  Result(Error error) : state_(std::move(error)) {}

  bool ok() const { return std::holds_alternative<T>(state_); }
  const Error& error() const {
    CHECK(!ok(), "error() of a successful Result");
    return std::get<Error>(state_);
  }
  T& operator*() & { return checked(); }
  const T& operator*() const& { return const_cast<Result*>(this)->checked(); }
  T&& operator*() && { return std::move(checked()); }
  T* operator->() { return &checked(); }
  const T* operator->() const { return &const_cast<Result*>(this)->checked(); }

 private:
  T& checked() {
    CHECK(ok(), "value of a failed Result: " + std::get<Error>(state_).message);
    return std::get<T>(state_);
  }
  std::variant<T, Error> state_;
};

struct Done {};
using Status = Result<Done>;

// Set-up impossible: no device, an unreadable sequence, a bad setting. Caught once, in main or by the scan.
class SetupError : public std::runtime_error {
 public:
  explicit SetupError(Error error) : std::runtime_error(error.message), error_(std::move(error)) {}
  const Error& error() const { return error_; }

 private:
  Error error_;
};

// The value, or its error as the exception that main puts into words: for programs, which can go on with nothing less.
template <class T>
T or_throw(Result<T> result) {
  if (!result.ok()) throw SetupError(result.error());
  return *std::move(result);
}

}  // namespace hermite
