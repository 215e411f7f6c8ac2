// Handles the command line of `hermite` and `hermite-client`.
#pragma once

#include <string>
#include <string_view>
#include <vector>

#include "server/commands.h"

namespace hermite::commands {

// Parses the arguments and runs the command that they name. Prints errors to stderr, as messages.
// Returns the exit status.
int run_command_line(CLI::App& app, const std::vector<Command>& commands, int argc,
                     const char* const* argv);

// Returns the name that the user probably meant by `word`: the nearest one, with at most two wrong
// letters, or the first one that starts with it; empty if there is none.
std::string nearest_name(std::string_view word, const std::vector<std::string>& names);

}  // namespace hermite::commands
