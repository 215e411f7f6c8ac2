// The namespace of a file is that of its folder, so that a name says where a thing lives and two
// folders cannot define the same one.
#include <gtest/gtest.h>

#include <array>
#include <filesystem>
#include <fstream>
#include <regex>
#include <sstream>
#include <string>
#include <string_view>
#include <vector>

#include "tests/source_root/source_root.h"

namespace hermite::namespaces_test {
namespace {

namespace fs = std::filesystem;
using test::source_root;

// The folders that are not called like their namespace. All others of core/ are, and all others of
// server/ are hermite::server.
struct Space {
  std::string_view folder, name;
};
constexpr std::array kSpaces = {
    Space{"core/base", "hermite"},  // what all share
    Space{"core/math", "hermite"},
    Space{"core/raw", "hermite"},
    Space{"core/export", "hermite::exports"},  // "export" and "import" are words of the language
    Space{"core/import", "hermite::imports"},
    Space{"core/log", "hermite::frame_log"},  // "log" is the logarithm
    Space{"proto/wire", "hermite::wire"},
    Space{"server", "hermite::commands"},
    Space{"server/client", "hermite::client"},
    Space{"server/capture", "hermite::client"},
};

// Returns the namespace of a folder like "core/map".
std::string space_of(const std::string& folder) {
  for (const Space& space : kSpaces)
    if (space.folder == folder) return std::string(space.name);
  return folder.starts_with("core/") ? "hermite::" + folder.substr(5) : "hermite::server";
}

// May a file open a namespace? A test has that of the folder that it tests, or one called like the
// file inside of it; helpers of tests are in hermite::test.
bool fits(const fs::path& path, const std::string& name) {
  const bool is_test = path.begin()->string() == "tests";
  const std::string folder = path.parent_path().generic_string(),
                    space = space_of(is_test ? folder.substr(6) : folder);
  if (name == space) return true;
  return is_test && (name == space + "::" + path.stem().string() || name == "hermite::test" ||
                     name.starts_with("hermite::test::"));
}

// Returns what is wrong with the namespaces of a file. Those of others may be opened to declare a
// type that is defined there.
std::vector<std::string> offences(const fs::path& path, const std::string& text) {
  static const std::regex opening(R"(^namespace (hermite[\w:]*) \{$)"),
      declaration(R"(^(class|struct|enum class) \w+;$)");
  static const std::regex directive(R"(^\s*using namespace )");
  std::vector<std::string> found, lines;
  std::istringstream stream(text);
  for (std::string line; std::getline(stream, line);) lines.push_back(line);
  for (std::size_t i = 0; i < lines.size(); ++i) {
    std::smatch match;
    const bool is_main = path.generic_string() == "server/hermite.cpp" ||
                         path.generic_string() == "server/hermite_client.cpp";
    if (std::regex_search(lines[i], directive) && !is_main &&
        lines[i].find("std::chrono_literals") == std::string::npos)
      found.push_back(path.generic_string() + ": " + lines[i]);
    if (!std::regex_match(lines[i], match, opening) || fits(path, match[1])) continue;
    std::size_t last = i + 1;
    while (last < lines.size() && std::regex_match(lines[last], declaration)) ++last;
    const bool only_declares = last > i + 1 && last < lines.size() && lines[last].starts_with("}");
    if (!only_declares)
      found.push_back(path.generic_string() + ": " + lines[i] + " in " +
                      path.parent_path().generic_string());
  }
  return found;
}

TEST(Namespaces, AreThoseOfTheirFolders) {
  std::size_t file_count = 0;
  for (const char* top :
       {"core", "proto/wire", "server", "tests/core", "tests/server", "tests/proto/wire"})
    for (const fs::directory_entry& entry : fs::recursive_directory_iterator(source_root() / top)) {
      const fs::path path = fs::relative(entry.path(), source_root());
      const std::string folder = path.parent_path().generic_string();
      if ((path.extension() != ".h" && path.extension() != ".cpp") || folder == "core/examples")
        continue;
      const bool mirrors_nothing =
          path.begin()->string() == "tests" && !fs::exists(source_root() / folder.substr(6));
      if (mirrors_nothing) continue;
      std::stringstream text;
      text << std::ifstream(entry.path()).rdbuf();
      for (const std::string& offence : offences(path, text.str())) ADD_FAILURE() << offence;
      ++file_count;
    }
  EXPECT_GT(file_count, 1000u);
}

TEST(Namespaces, OffencesAreSeen) {
  const auto count = [](const char* path, const std::string& text) {
    return offences(path, text).size();
  };
  EXPECT_EQ(count("core/map/a.h", "namespace hermite::map {\n"), 0u);
  EXPECT_EQ(count("core/map/a.h", "namespace hermite {\n"), 1u);
  EXPECT_EQ(count("core/map/a.h", "namespace hermite::frame {\nclass Frame;\n}\n"), 0u)
      << "a declaration";
  EXPECT_EQ(count("core/map/a.h", "namespace hermite::frame {\nclass Frame {};\n}\n"), 1u);
  EXPECT_EQ(count("core/base/a.h", "namespace hermite {\n"), 0u);
  EXPECT_EQ(count("core/log/a.h", "namespace hermite::frame_log {\n"), 0u);
  EXPECT_EQ(count("server/scan/a.h", "namespace hermite::server {\n"), 0u);
  EXPECT_EQ(count("server/command_a.cpp", "namespace hermite::server {\n"), 1u);
  EXPECT_EQ(count("server/scan/a.cpp", "  using namespace hermite::map;\n"), 1u);
  EXPECT_EQ(count("tests/core/map/a_test.cpp", "namespace hermite::map::a_test {\n"), 0u);
  EXPECT_EQ(count("tests/core/map/a_test.cpp", "namespace hermite::a_test {\n"), 1u);
  EXPECT_EQ(count("tests/core/map/a_contract.h", "namespace hermite::test {\n"), 0u);
}

}  // namespace
}  // namespace hermite::namespaces_test
