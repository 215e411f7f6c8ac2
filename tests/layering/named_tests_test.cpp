// server/SECURITY.md and tests/not_sanitized.txt name tests and scripts; they exist.
#include <gtest/gtest.h>

#include <filesystem>
#include <fstream>
#include <iterator>
#include <regex>
#include <set>
#include <sstream>
#include <string>

#include "tests/source_root/source_root.h"

namespace hermite {
namespace {

namespace fs = std::filesystem;

std::string text_of(const fs::path& path) {
  std::ifstream file(path);
  return {std::istreambuf_iterator<char>(file), std::istreambuf_iterator<char>()};
}

std::set<std::string> matches(const std::string& text, const std::regex& pattern) {
  std::set<std::string> found;
  for (std::sregex_iterator match(text.begin(), text.end(), pattern), end; match != end; ++match)
    found.insert((*match)[1].str() + "." + (*match)[2].str());
  return found;
}

// "Suite.Name" of every test in the sources.
std::set<std::string> all_tests() {
  std::set<std::string> tests;
  for (const fs::directory_entry& entry :
       fs::recursive_directory_iterator(test::source_root() / "tests"))
    if (entry.is_regular_file() &&
        (entry.path().extension() == ".cpp" || entry.path().extension() == ".h"))
      tests.merge(
          matches(text_of(entry.path()), std::regex(R"(TEST(?:_F|_P)?\((\w+),\s*(\w+)\))")));
  return tests;
}

TEST(SecurityTable, NamesTestsThatExist) {
  const fs::path root = test::source_root();
  const std::set<std::string> tests = all_tests();
  const std::string table = text_of(root / "server/SECURITY.md");
  const std::set<std::string> named = matches(table, std::regex(R"(`(\w+)\.(\w+)`)"));
  EXPECT_GT(named.size(), 30u) << "is this the table?";
  const std::regex script(R"(`(tests/[\w/]+(?:\.\w+)?)[ \w]*`)");
  for (std::sregex_iterator match(table.begin(), table.end(), script), end; match != end; ++match)
    EXPECT_TRUE(fs::exists(root / (*match)[1].str()))
        << (*match)[1] << " is named in server/SECURITY.md";
  for (const std::string& name : named)
    EXPECT_TRUE(tests.contains(name)) << name << " is named in server/SECURITY.md and nowhere else";
}

// A name may have the prefix of tests with values, and all of these in place of one:
// "All/Suite.Name/*", "Suite.*". A script is one of tests/CMakeLists.txt.
TEST(NotSanitized, NamesTestsThatExist) {
  const std::set<std::string> tests = all_tests();
  const std::string scripts = text_of(test::source_root() / "tests/CMakeLists.txt");
  std::istringstream text(text_of(test::source_root() / "tests/not_sanitized.txt"));
  std::string line;
  while (std::getline(text, line) && !line.empty()) continue;  // what is said before the list
  std::size_t count = 0;
  for (; std::getline(text, line); ++count) {
    std::smatch name;
    if (std::regex_search(line, name, std::regex(R"(^([A-Za-z]+)\.\*  )")))
      EXPECT_TRUE(tests.lower_bound(name[1].str() + ".")->starts_with(name[1].str() + ".")) << line;
    else if (std::regex_search(
                 line, name,
                 std::regex(R"(^(?:[A-Za-z]+/)?([A-Za-z]+)\.([A-Za-z0-9]+)(?:/\*)?  )")))
      EXPECT_TRUE(tests.contains(name[1].str() + "." + name[2].str())) << line;
    else if (std::regex_search(line, name, std::regex("^([a-z0-9_]+)  ")))
      EXPECT_TRUE(std::regex_search(scripts, std::regex("[ (]" + name[1].str() + "[ )]"))) << line;
    else
      ADD_FAILURE() << "neither a test nor a script, two spaces and a reason: " << line;
  }
  EXPECT_GT(count, 10u) << "is this the list?";
}

}  // namespace
}  // namespace hermite
