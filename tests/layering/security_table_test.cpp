// server/SECURITY.md names tests and scripts; they exist.
#include <gtest/gtest.h>

#include <filesystem>
#include <fstream>
#include <iterator>
#include <regex>
#include <set>
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

TEST(SecurityTable, NamesTestsThatExist) {
  const fs::path root = test::source_root();
  std::set<std::string> tests;
  for (const fs::directory_entry& entry : fs::recursive_directory_iterator(root / "tests"))
    if (entry.is_regular_file() && (entry.path().extension() == ".cpp" || entry.path().extension() == ".h"))
      tests.merge(matches(text_of(entry.path()), std::regex(R"(TEST(?:_F|_P)?\((\w+),\s*(\w+)\))")));
  const std::set<std::string> named = matches(text_of(root / "server/SECURITY.md"), std::regex(R"(`(\w+)\.(\w+)`)"));
  EXPECT_GT(named.size(), 30u) << "is this the table?";
  const std::string table = text_of(root / "server/SECURITY.md");
  const std::regex script(R"(`(tests/[\w/]+(?:\.\w+)?)[ \w]*`)");
  for (std::sregex_iterator match(table.begin(), table.end(), script), end; match != end; ++match)
    EXPECT_TRUE(fs::exists(root / (*match)[1].str())) << (*match)[1] << " is named in server/SECURITY.md";
  for (const std::string& name : named) EXPECT_TRUE(tests.contains(name)) << name << " is named in server/SECURITY.md and nowhere else";
}

}  // namespace
}  // namespace hermite
