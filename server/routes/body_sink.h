// Where the body of a request goes that is too long for memory: piece by piece, as it comes.
#pragma once

#include <functional>
#include <string_view>

#include "core/base/result.h"

namespace hermite {

struct HttpAnswer;

class BodySink {
 public:
  virtual ~BodySink() = default;

  // On a thread for the disk, one call at a time. After an error nothing more is written.
  virtual Status write(std::string_view piece) = 0;
  virtual void close(bool complete) = 0;  // once, at last. `complete`: all that was announced has come

  // On the network thread.
  virtual bool wanted() const = 0;                          // false: no more needs to be read
  virtual void on_unwanted(std::function<void()> run) = 0;  // called when it becomes so
  virtual HttpAnswer answer() = 0;                          // once, after close()
};

}  // namespace hermite
