#include "proto/wire/without_paths.h"

#include <string_view>

namespace hermite::wire {

namespace {

// A path begins behind one of these, or at the beginning.
bool may_precede(char c) {
  return std::string_view(" \t\n\"'([{=<,;").find(c) != std::string_view::npos;
}

// A path may have spaces. It ends at the end of its clause: ": ", "; ", ", ", " (" or a quote.
std::size_t end_of_path(const std::string& message, std::size_t from) {
  for (std::size_t at = from; at < message.size(); ++at) {
    const char c = message[at], next = at + 1 < message.size() ? message[at + 1] : ' ';
    if (c == '"' || c == '\'' || c == ')' || c == ']' || c == '\n') return at;
    if ((c == ':' || c == ';' || c == ',') && next == ' ') return at;
    if (c == ' ' && next == '(') return at;
  }
  return message.size();
}

}  // namespace

std::string without_paths(const std::string& message) {
  std::string told;
  for (std::size_t at = 0; at < message.size();) {
    const bool begins = message[at] == '/' && (at == 0 || may_precede(message[at - 1])) &&
                        at + 1 < message.size() && message[at + 1] != ' ';
    if (!begins || message.compare(at, 5, "/api/") == 0) {
      told += message[at++];
      continue;
    }
    const std::size_t end = end_of_path(message, at);
    std::size_t last = message.rfind('/', end - 1);
    // A folder named with a slash at its end.
    if (last + 1 == end && last > at) last = message.rfind('/', last - 1);
    told += message.substr(last + 1, end - last - 1);
    at = end;
  }
  return told;
}

}  // namespace hermite::wire
