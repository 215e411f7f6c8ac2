// Receives a request body that is too long for memory, piece by piece.
#pragma once

#include <functional>
#include <string_view>

#include "core/base/result.h"

namespace hermite::server {

struct HttpAnswer;

class BodySink {
 public:
  virtual ~BodySink() = default;

  // Called on a disk thread, one call at a time. After an error no more pieces are passed.
  virtual Status write(std::string_view piece) = 0;
  // Called once, last. `complete`: the whole announced body was received.
  virtual void close(bool complete) = 0;

  // The functions below are called on the network thread.

  // False: the rest of the body need not be read.
  virtual bool wanted() const = 0;
  // `run` is called once wanted() becomes false.
  virtual void on_unwanted(std::function<void()> run) = 0;
  virtual HttpAnswer answer() = 0;  // called once, after close()
};

}  // namespace hermite::server
