// Expected failures: corrupt bytes, a missing file, a full disk, a device that runs out of memory.
//
//   Result<Image> image = decode_png(bytes, limits);
//   if (!image.ok()) return image.error();
//   use(*image);
//
// There are three separate kinds of failure: expected ones are a Result; an impossible set-up
// throws SetupError, which is caught once per scan or in main; programming errors are a CHECK
// (core/base/check.h). Values: thread-compatible, no hidden sharing.
#pragma once

#include <stdexcept>
#include <string>
#include <utility>
#include <variant>

#include "core/base/check.h"

namespace hermite {

enum class ErrorCode {
  kInvalidArgument,  // the caller's value is outside its documented range
  kNotFound,
  kCorruptData,  // bytes that are not valid data of their format
  kTooLarge,     // a stated limit would be exceeded
  kUnsupported,  // valid, but this build cannot do it
  kIo,           // the operating system reported an error
  kDevice,       // GPU missing, lost or out of memory
  kUnauthorized,
  kBusy,         // try again later
  kUnavailable,  // another service that this needs does not answer: try again later
};

// Returns one word for logs, JSON and the protocol, such as "corrupt_data".
const char* name_of(ErrorCode code);

struct Error {
  ErrorCode code = ErrorCode::kInvalidArgument;
  std::string message;  // for people: names the field, the value and the limit
};

// Returns the error with the message "context: inner message" and the same code, to say where it
// happened.
Error in_context(const std::string& context, const Error& error);

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
  // By value, so that a loop over *f() or a reference to it does not outlive it.
  T operator*() && { return std::move(checked()); }
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

// The set-up is impossible: no device, an unreadable sequence, an invalid setting. Caught once, in
// main or by the scan.
class SetupError : public std::runtime_error {
 public:
  explicit SetupError(Error error) : std::runtime_error(error.message), error_(std::move(error)) {}
  const Error& error() const { return error_; }

 private:
  Error error_;
};

// Returns the value, or throws its error as the exception that main reports: for programs that
// cannot continue without it.
template <class T>
T or_throw(Result<T> result) {
  if (!result.ok()) throw SetupError(result.error());
  return *std::move(result);
}

}  // namespace hermite
