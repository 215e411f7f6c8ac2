// What `hermite` and `hermite-client` do with their arguments.
#pragma once

#include <string>
#include <string_view>
#include <vector>

#include "server/commands.h"

namespace hermite {

// Parses the arguments and runs the command that they name. What is wrong goes to stderr, in words. The exit status.
int run_command_line(CLI::App& app, const std::vector<Command>& commands, int argc, const char* const* argv);

// The name that somebody meant who has typed `word`: the nearest, with at most two letters wrong, or the first that begins with it; empty:
// none.
std::string nearest_name(std::string_view word, const std::vector<std::string>& names);

}  // namespace hermite
