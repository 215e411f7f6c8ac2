#include "server/command_line.h"

#include <fmt/core.h>

#include <CLI/CLI.hpp>
#include <algorithm>
#include <exception>
#include <iostream>
#include <numeric>

namespace hermite::commands {

namespace {

// Returns how many letters must be inserted, removed or changed to turn `a` into `b`.
std::size_t edit_distance(std::string_view a, std::string_view b) {
  std::vector<std::size_t> row(b.size() + 1);
  std::iota(row.begin(), row.end(), std::size_t{0});
  for (std::size_t i = 1; i <= a.size(); ++i) {
    std::size_t diagonal = std::exchange(row[0], i);
    for (std::size_t j = 1; j <= b.size(); ++j) {
      const std::size_t changed = diagonal + (a[i - 1] == b[j - 1] ? 0 : 1);
      diagonal = std::exchange(row[j], std::min({row[j] + 1, row[j - 1] + 1, changed}));
    }
  }
  return row.back();
}

// Returns a message if the first argument is an unknown command; otherwise an empty text.
std::string unknown_command(const CLI::App& app, const std::vector<Command>& commands, int argc,
                            const char* const* argv) {
  const std::string word = argc > 1 ? argv[1] : "";
  if (word.empty() || word.front() == '-') return {};
  std::vector<std::string> names;
  for (const Command& command : commands) names.push_back(command.app->get_name());
  if (std::find(names.begin(), names.end(), word) != names.end()) return {};
  const std::string meant = nearest_name(word, names);
  std::string message =
      fmt::format("there is no command \"{}\"{}\nCommands:", word,
                  meant.empty() ? "" : fmt::format("; did you mean \"{}\"?", meant));
  for (const std::string& name : names) message += " " + name;
  return fmt::format("{}\n{} --help has more", message, app.get_name());
}

}  // namespace

std::string nearest_name(std::string_view word, const std::vector<std::string>& names) {
  constexpr std::size_t kWrongLetters = 2;
  std::string nearest;
  std::size_t least = kWrongLetters + 1;
  for (const std::string& name : names)
    // Of a short word hardly any letter would remain.
    if (const std::size_t distance = edit_distance(word, name);
        distance < std::min(least, word.size())) {
      nearest = name;
      least = distance;
    }
  if (!nearest.empty() || word.empty()) return nearest;
  const auto begun = std::find_if(names.begin(), names.end(), [word](const std::string& name) {
    return name.starts_with(word);
  });
  return begun == names.end() ? "" : *begun;
}

int run_command_line(CLI::App& app, const std::vector<Command>& commands, int argc,
                     const char* const* argv) {
  app.require_subcommand(1);
  app.set_version_flag("--version", app.get_name() + " " HERMITE_VERSION);
  const auto fail_with = [&app](int status, const std::string& message) {
    std::cerr << app.get_name() << ": " << message << '\n';
    return status;
  };
  const bool asks = argc > 1 && std::string_view(argv[1]) == "help";
  if (argc < 2 || asks) {
    (asks ? std::cout : std::cerr) << app.help();
    return asks ? 0 : kUsage;
  }
  if (const std::string message = unknown_command(app, commands, argc, argv); !message.empty())
    return fail_with(kUsage, message);
  try {
    app.parse(argc, argv);
    for (const Command& command : commands)
      if (command.app->parsed()) return command.run();
  } catch (const CLI::ParseError& error) {
    return app.exit(error) == 0 ? 0 : kUsage;
  } catch (const SetupError& error) {
    return fail_with(error.error().code == ErrorCode::kInvalidArgument ? kUsage : kFailed,
                     error.what());
  } catch (const std::exception& error) {
    return fail_with(kFailed, error.what());
  }
  return kUsage;
}

}  // namespace hermite::commands
