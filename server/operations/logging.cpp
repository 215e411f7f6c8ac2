#include "server/operations/logging.h"

#include <fmt/core.h>
#include <spdlog/pattern_formatter.h>
#include <spdlog/sinks/base_sink.h>
#include <spdlog/sinks/ostream_sink.h>
#include <spdlog/spdlog.h>

#include <array>
#include <chrono>
#include <cstdio>
#include <mutex>
#include <nlohmann/json.hpp>
#include <string_view>
#include <unordered_map>

#include "server/store/unix_time.h"

namespace hermite::server {

namespace {

// Hashes and tokens are longer; ids of scans also have other letters.
constexpr std::size_t kTokenDigits = 32;
constexpr std::size_t kMaxLineKinds = 256;  // counted at once; bounds the memory

// spdlog has no fields. Its sinks run on the thread that logs, so they find the fields here.
thread_local const LogFields* fields_of_this_line = nullptr;

bool is_hex(char c) {
  return (c >= '0' && c <= '9') || (c >= 'a' && c <= 'f') || (c >= 'A' && c <= 'F');
}
bool is_word(char c) {
  return is_hex(c) || (c >= 'a' && c <= 'z') || (c >= 'A' && c <= 'Z') || c == '-' || c == '_';
}

std::string without_secrets(std::string_view text) {
  constexpr std::string_view kKey = "token=";
  std::string result;
  for (std::size_t i = 0; i < text.size();) {
    std::size_t end = i;
    const bool named = text.substr(i).starts_with(kKey);
    if (named) {
      result += kKey;
      i = end = i + kKey.size();
      while (end < text.size() && is_word(text[end])) ++end;
    } else {
      while (end < text.size() && is_hex(text[end])) ++end;
    }
    if (end - i >= (named ? 1 : kTokenDigits))
      result += "[secret]";
    else
      result += text.substr(i, end - i);
    if (!named && end == i) result += text[end++];
    i = end;
  }
  return result;
}

std::string utc(spdlog::log_clock::time_point time) {
  return utc_text(
      std::chrono::duration_cast<std::chrono::milliseconds>(time.time_since_epoch()).count());
}

std::string json_line(const spdlog::details::log_msg& line, const std::string& message) {
  nlohmann::ordered_json json;
  json["ts"] = utc(line.time);
  json["level"] = std::string(spdlog::level::to_string_view(line.level).data());
  json["msg"] = message;
  if (const LogFields* fields = fields_of_this_line) {
    if (!fields->session.empty()) json["session"] = fields->session;
    if (!fields->remote.empty()) json["remote"] = fields->remote;
    if (fields->duration_s) json["duration"] = *fields->duration_s;
  }
  return json.dump(-1, ' ', false, nlohmann::ordered_json::error_handler_t::replace);
}

// Control characters would let a client forge lines.
std::string text_line(const spdlog::details::log_msg& line, std::string message) {
  for (char& c : message)
    if (static_cast<unsigned char>(c) < 0x20 || c == 0x7f) c = '?';
  std::string text = fmt::format("{} {} {}", utc(line.time),
                                 spdlog::level::to_string_view(line.level).data(), message);
  if (const LogFields* fields = fields_of_this_line) {
    if (!fields->session.empty()) text += " session=" + fields->session;
    if (!fields->remote.empty()) text += " remote=" + fields->remote;
    char seconds[32];
    if (fields->duration_s) {
      std::snprintf(seconds, sizeof seconds, " duration=%.3fs", *fields->duration_s);
      text += seconds;
    }
  }
  return text;
}

class Lines final : public spdlog::sinks::base_sink<std::mutex> {
 public:
  Lines(std::ostream& out, LogFormat format) : out_(out), format_(format) {}

 private:
  struct Kind {
    spdlog::log_clock::time_point since;
    int count = 0;
  };

  void sink_it_(const spdlog::details::log_msg& line) override {
    const std::string_view payload(line.payload.data(), line.payload.size());
    const std::optional<int> left_out = admit(line, payload);
    if (!left_out) return;
    std::string message = without_secrets(payload);
    if (*left_out > 0) message += fmt::format(" (and {} more like this)", *left_out);
    out_ << (format_ == LogFormat::kJson ? json_line(line, message)
                                         : text_line(line, std::move(message)))
         << '\n'
         << std::flush;
  }
  void flush_() override { out_.flush(); }

  // Returns how many similar lines were left out before this one; std::nullopt if this one is to be
  // left out.
  std::optional<int> admit(const spdlog::details::log_msg& line, std::string_view payload) {
    std::string key(1, static_cast<char>('0' + line.level));
    for (const char c : payload)
      if (c < '0' || c > '9') key += c;
    if (kinds_.size() >= kMaxLineKinds && !kinds_.contains(key))
      std::erase_if(kinds_,
                    [&](const auto& kind) { return line.time - kind.second.since >= kLogWindow; });
    if (kinds_.size() >= kMaxLineKinds && !kinds_.contains(key)) kinds_.clear();
    const auto [found, is_new] = kinds_.try_emplace(std::move(key), Kind{line.time, 0});
    Kind& kind = found->second;
    int left_out = 0;
    if (line.time - kind.since >= kLogWindow) {
      left_out = std::max(0, kind.count - kLinesPerWindow);
      kind = {line.time, 0};
    }
    return ++kind.count <= kLinesPerWindow ? std::optional<int>(left_out) : std::nullopt;
  }

  std::ostream& out_;
  const LogFormat format_;
  std::unordered_map<std::string, Kind> kinds_;
};

}  // namespace

std::shared_ptr<spdlog::logger> make_logger(std::ostream& out, LogFormat format,
                                            const std::string& level) {
  auto logger = std::make_shared<spdlog::logger>("hermite", std::make_shared<Lines>(out, format));
  logger->set_level(spdlog::level::from_str(level));
  return logger;
}

void log_with(const LogFields& fields, spdlog::level::level_enum level,
              const std::string& message) {
  fields_of_this_line = &fields;
  spdlog::default_logger_raw()->log(level, message);
  fields_of_this_line = nullptr;
}

}  // namespace hermite::server
