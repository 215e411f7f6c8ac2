// A type's name, with its namespace, is defined in one header: two of the same name in one program
// would share their templates and inline functions, whatever their members are, and neither
// compiler nor linker would say so.
#include <gtest/gtest.h>

#include <algorithm>
#include <filesystem>
#include <fstream>
#include <map>
#include <regex>
#include <sstream>
#include <string>
#include <vector>

#include "tests/source_root/source_root.h"

namespace hermite::type_names_test {
namespace {

namespace fs = std::filesystem;
using test::source_root;

using Places = std::map<std::string, std::string>;  // the first header of each name

// Returns the types outside of other types that the text defines and an earlier header has defined,
// with both headers.
std::vector<std::string> defined_again(const std::string& path, const std::string& text,
                                       Places& places) {
  static const std::regex opening(R"(^namespace ([\w:]+) \{)");
  static const std::regex definition(
      R"(^(?:struct|class|union|enum|enum class) (\w+)(?: final)?(?: : [^;]*)? \{)");
  std::vector<std::string> again;
  std::istringstream lines(text);
  std::string space;
  for (std::string line; std::getline(lines, line);) {
    std::smatch match;
    if (std::regex_search(line, match, opening)) space = match[1].str() + "::";
    if (!std::regex_search(line, match, definition)) continue;
    const auto [first, is_new] = places.emplace(space + match[1].str(), path);
    if (!is_new)
      again.push_back(first->first + " is defined in " + first->second + " and in " + path);
  }
  return again;
}

TEST(TypeNames, AreDefinedInOneHeader) {
  std::vector<std::string> headers;
  for (const char* folder : {"core", "server"})
    for (const fs::directory_entry& entry :
         fs::recursive_directory_iterator(source_root() / folder))
      if (entry.path().extension() == ".h")
        headers.push_back(fs::relative(entry.path(), source_root()).string());
  std::ranges::sort(headers);
  EXPECT_GT(headers.size(), 300u);
  Places places;
  for (const std::string& header : headers) {
    std::stringstream text;
    text << std::ifstream(source_root() / header).rdbuf();
    for (const std::string& offence : defined_again(header, text.str(), places))
      ADD_FAILURE() << offence;
  }
}

TEST(TypeNames, OffencesAreSeen) {
  Places places;
  EXPECT_TRUE(
      defined_again("a.h",
                    "namespace a {\nstruct View {\n};\nenum class Kind { kOne };\nstruct Later;\n",
                    places)
          .empty());
  EXPECT_TRUE(defined_again("c.h", "namespace c {\nclass View {\n};\n", places).empty());
  EXPECT_EQ(defined_again("b.h",
                          "namespace a {\nclass View final : public Base {\n  struct Kind {\n  "
                          "};\n};\nstruct Later {\n",
                          places),
            std::vector<std::string>{"a::View is defined in a.h and in b.h"});
}

}  // namespace
}  // namespace hermite::type_names_test
