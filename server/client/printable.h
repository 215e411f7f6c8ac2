// Text of other people, as it may be printed on a terminal. Pure function.
#pragma once

#include <string>

namespace hermite::client {

// Returns the text with '?' in place of control characters: the title of another user could
// otherwise move the cursor or change the colours of the terminal.
std::string printable(std::string text);

}  // namespace hermite::client
