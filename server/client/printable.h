// Text of other people, as it may be printed on a terminal. Pure function.
#pragma once

#include <string>

namespace hermite::client {

// Returns the UTF-8 text with a question mark in place of each control character: the title of
// another user could otherwise move the cursor or change the colours of the terminal.
std::string printable(const std::string& text);

}  // namespace hermite::client
