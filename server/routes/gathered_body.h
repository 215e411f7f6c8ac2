// The body of a request that is kept whole in memory because it is small: a note, or points to
// measure.
#pragma once

#include <fmt/core.h>

#include <functional>
#include <memory>
#include <optional>
#include <string>
#include <string_view>
#include <utility>

#include "server/routes/body_sink.h"
#include "server/routes/scan_routes.h"
#include "server/store/unix_time.h"

namespace hermite::server {

// Threads are those of BodySink. The server must outlive it.
class GatheredBody : public BodySink {
 public:
  GatheredBody(const HttpWorld& world, const Call& call)
      : world_(world), scan_id_(call.id), grant_(call.grant) {}

  Status write(std::string_view piece) override {
    body_ += piece;
    return Done{};
  }
  bool wanted() const override { return world_.gate.holds(grant_, unix_now_ms()); }
  void on_unwanted(std::function<void()>) override {}

 protected:
  const HttpWorld& world_;
  const std::string scan_id_;
  const Grant grant_;
  std::string body_;
};

// Returns the refusal of a body that is announced as empty, or as longer than `most_bytes`.
inline std::optional<HttpAnswer> wrong_size(const Call& call, std::size_t most_bytes) {
  const std::uint64_t body_bytes = call.request.body_bytes;
  if (body_bytes > 0 && body_bytes <= most_bytes) return std::nullopt;
  return error_answer(
      body_bytes == 0 ? 400 : 413,
      {ErrorCode::kInvalidArgument,
       fmt::format("the body has {} bytes, allowed are 1 to {}", body_bytes, most_bytes)});
}

// Returns the answer that makes the server pass the body to `sink` and then ask that for an answer.
inline HttpAnswer received_into(std::shared_ptr<BodySink> sink) {
  HttpAnswer answer;
  answer.body_sink = std::move(sink);
  return answer;
}

}  // namespace hermite::server
