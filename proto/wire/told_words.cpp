#include "proto/wire/told_words.h"

#include <string_view>

namespace hermite::wire {

namespace {

// A path begins behind one of these, or at the beginning.
bool may_precede(char c) { return std::string_view(" \t\n\"'([{=<,;").find(c) != std::string_view::npos; }

// A path may have spaces. It ends at the end of its clause: ": ", "; ", ", ", " (" or a quote.
std::size_t end_of_path(const std::string& words, std::size_t from) {
  for (std::size_t at = from; at < words.size(); ++at) {
    const char c = words[at], next = at + 1 < words.size() ? words[at + 1] : ' ';
    if (c == '"' || c == '\'' || c == ')' || c == ']' || c == '\n') return at;
    if ((c == ':' || c == ';' || c == ',') && next == ' ') return at;
    if (c == ' ' && next == '(') return at;
  }
  return words.size();
}

}  // namespace

std::string told_words(const std::string& words) {
  std::string told;
  for (std::size_t at = 0; at < words.size();) {
    const bool begins = words[at] == '/' && (at == 0 || may_precede(words[at - 1])) && at + 1 < words.size() && words[at + 1] != ' ';
    if (!begins || words.compare(at, 5, "/api/") == 0) {
      told += words[at++];
      continue;
    }
    const std::size_t end = end_of_path(words, at);
    std::size_t last = words.rfind('/', end - 1);
    // A folder named with a slash at its end.
    if (last + 1 == end && last > at) last = words.rfind('/', last - 1);
    told += words.substr(last + 1, end - last - 1);
    at = end;
  }
  return told;
}

}  // namespace hermite::wire
