// How long files, functions and lines may be, how many parameters a function and methods a class
// has, and how much of the project a file includes. Whoever meets a limit has two things in one:
// see CONTRIBUTING.md.
#include <gtest/gtest.h>

#include <algorithm>
#include <array>
#include <cctype>
#include <filesystem>
#include <fstream>
#include <functional>
#include <iterator>
#include <optional>
#include <regex>
#include <sstream>
#include <string>
#include <string_view>
#include <vector>

#include "tests/source_root/source_root.h"

namespace hermite::limits_test {
namespace {

namespace fs = std::filesystem;

constexpr std::size_t kMostLines = 400, kMostLinesOfATest = 720, kMostColumns = 100,
                      kMostFunctionLines = 60, kMostParameters = 5, kMostIncludes = 25,
                      kMostMethods = 30;

// What is beyond a limit from the time before it: the count that it may have and must not exceed.
// Whoever mends one removes its row.
struct Excess {
  std::string_view path, name;
  std::size_t count;
};
constexpr std::array kManyParameters = {
    Excess{"core/map/predict.cpp", "Predictor::run", 6},
    Excess{"core/pipeline/reconstruction.h", "Reconstruction", 6},
};

template <std::size_t Count>
std::size_t allowed(const std::array<Excess, Count>& excesses, std::string_view path,
                    std::string_view name, std::size_t most) {
  const auto known = std::find_if(excesses.begin(), excesses.end(), [&](const Excess& one) {
    return one.path == path && one.name == name;
  });
  return known == excesses.end() ? most : known->count;
}

struct Function {
  std::string head;
  std::size_t line = 0, line_count = 0, parameter_count = 0;
};

// Comments, texts and letters become spaces, so that what is left can be counted by its brackets.
// Lines stay lines.
std::string code_of(const std::string& text) {
  static const std::regex hidden(
      R"(//[^\n]*|"(?:[^"\\\n]|\\.)*"|'(?:[^'\\\n]|\\.)'|^[ \t]*#[^\n]*)",
      std::regex::ECMAScript | std::regex::multiline);
  std::string code;
  auto from = text.cbegin();
  for (std::sregex_iterator found(text.begin(), text.end(), hidden), end; found != end; ++found) {
    code.append(from, text.cbegin() + found->position())
        .append(static_cast<std::size_t>(found->length()), ' ');
    from = text.cbegin() + found->position() + found->length();
  }
  return code.append(from, text.cend());
}

// Of the first parentheses in `head`.
std::size_t parameters_of(const std::string& head) {
  const std::size_t open = head.find('(');
  if (open == std::string::npos) return 0;
  int depth = 0;
  std::size_t count = 0;
  for (std::size_t i = open; i < head.size(); ++i) {
    const char letter = head[i];
    if (letter == '(' || letter == '<' || letter == '[' || letter == '{') ++depth;
    if ((letter == '>' && head[i - 1] != '-') || letter == ']' || letter == '}') --depth;
    if (letter == ')' && --depth == 0)
      return head.find_first_not_of(" \n", open + 1) == i ? 0 : count + 1;
    if (letter == ',' && depth == 1) ++count;
  }
  return count + 1;
}

// What is defined outside of functions: a block behind parentheses that stands in namespaces and
// classes only.
std::vector<Function> functions_of(const std::string& code) {
  static const std::regex container(R"(\b(namespace|struct|class|union|enum|extern)\b[^()=]*$)"),
      value(R"([=,]\s*$|\breturn\b)");
  std::vector<Function> functions;
  std::vector<bool> is_container;
  std::size_t line = 1, head_begin = 0, depth_of_function = 0;
  for (std::size_t i = 0; i < code.size(); ++i) {
    if (code[i] == '\n') ++line;
    if (code[i] == '{') {
      const std::string head = code.substr(head_begin, i - head_begin);
      const bool outside =
          std::all_of(is_container.begin(), is_container.end(), [](bool one) { return one; });
      is_container.push_back(outside && std::regex_search(head, container));
      if (outside && !is_container.back() && head.find('(') != std::string::npos &&
          !std::regex_search(head, value)) {
        const std::size_t first = head_begin + std::min(head.find_first_not_of(" \n"), head.size());
        const auto lines_of_head = static_cast<std::size_t>(
            std::count(code.begin() + static_cast<std::ptrdiff_t>(first),
                       code.begin() + static_cast<std::ptrdiff_t>(i), '\n'));
        functions.push_back({code.substr(first, std::min<std::size_t>(i - first, 80)),
                             line - lines_of_head, 0, parameters_of(head)});
        depth_of_function = is_container.size();
      }
    }
    if (code[i] == '}' && !is_container.empty()) {
      if (is_container.size() == depth_of_function && functions.back().line_count == 0)
        functions.back().line_count = line - functions.back().line + 1;
      is_container.pop_back();
    }
    if (code[i] == ';' || code[i] == '{' || code[i] == '}') head_begin = i + 1;
  }
  return functions;
}

// The last word before the first parentheses, with the classes that it stands in.
std::string name_in(const std::string& head) {
  const std::size_t open = std::min(head.find('('), head.size());
  std::size_t from = open;
  while (from > 0 && (std::isalnum(static_cast<unsigned char>(head[from - 1])) ||
                      head[from - 1] == '_' || head[from - 1] == ':'))
    --from;
  return head.substr(from, open - from);
}

// Does a statement in a class declare a method that is neither deleted nor the compiler's own? A
// member whose type or value has parentheses is none.
bool is_method(const std::string& statement) {
  static const std::regex label(R"(^\s*((public|private|protected)\s*:\s*)*)"),
      other(R"(^(using|typedef|static_assert|friend|enum)\b|=\s*(delete|default)$)");
  const std::string head =
      std::regex_replace(statement, label, "", std::regex_constants::format_first_only);
  if (std::regex_search(head, other)) return false;
  int depth = 0;
  for (std::size_t i = 0; i < head.size(); ++i) {
    if (head.compare(i, 8, "operator") == 0) return true;
    if (head[i] == '<') ++depth;
    if (head[i] == '>') --depth;
    if (depth == 0 && head[i] == '=') return false;
    if (depth == 0 && head[i] == '(') return true;
  }
  return false;
}

struct Class {
  std::string name;
  std::size_t method_count = 0;
};

std::vector<Class> classes_of(const std::string& code) {
  static const std::regex head_of_class(
      R"(\b(?:struct|class)\s+(?:alignas\([^)]*\)\s*)?([\w:]+)[^()=;]*$)");
  std::vector<Class> classes;
  std::vector<std::optional<std::size_t>> blocks;  // those that are open: which class each is
  std::size_t begin = 0;
  for (std::size_t i = 0; i < code.size(); ++i) {
    const std::string statement =
        code[i] == ';' || code[i] == '{' ? code.substr(begin, i - begin) : "";
    if (!statement.empty() && !blocks.empty() && blocks.back() && is_method(statement))
      ++classes[*blocks.back()].method_count;
    if (code[i] == '{') {
      std::smatch found;
      const bool may_be_class = statement.find("class") != std::string::npos ||
                                statement.find("struct") != std::string::npos;
      const bool is_class = may_be_class && std::regex_search(statement, found, head_of_class);
      blocks.push_back(is_class ? std::optional(classes.size()) : std::nullopt);
      if (is_class) classes.push_back({found[1].str()});
    }
    if (code[i] == '}' && !blocks.empty()) blocks.pop_back();
    if (code[i] == ';' || code[i] == '{' || code[i] == '}') begin = i + 1;
  }
  return classes;
}

// The files of the viewer and the scripts of tests. Biome limits their functions.
bool is_of_the_web(std::string_view extension) {
  constexpr std::array kExtensions = {".ts", ".js", ".mjs", ".css", ".html"};
  return std::find(kExtensions.begin(), kExtensions.end(), extension) != kExtensions.end();
}

// Is the line nothing but a text in quotes? Texts for people are not cut into pieces.
bool is_one_text(const std::string& line) {
  static const std::regex one_text(R"(^\s*('([^'\\]|\\.)*'|"([^"\\]|\\.)*"|`.*`)[,;]?$)");
  return std::regex_search(line, one_text);
}

using Check = std::function<void(const std::string& what, std::size_t count, std::size_t most)>;

void check_columns(const std::string& text, const Check& check, bool texts_may_be_long = false) {
  std::istringstream lines(text);
  std::size_t number = 0;
  for (std::string line; std::getline(lines, line);) {
    ++number;
    const auto columns = static_cast<std::size_t>(std::count_if(
        line.begin(), line.end(), [](char letter) { return (letter & 0xc0) != 0x80; }));
    if (columns > kMostColumns && !(texts_may_be_long && is_one_text(line)))
      check("columns of line " + std::to_string(number), columns, kMostColumns);
  }
}

std::vector<std::string> offences(const std::string& path, const std::string& text) {
  std::vector<std::string> found;
  const Check check = [&](const std::string& what, std::size_t count, std::size_t most) {
    if (count > most)
      found.push_back(path + ": " + what + ", " + std::to_string(count) + " of at most " +
                      std::to_string(most));
  };
  if (is_of_the_web(fs::path(path).extension().string())) {
    check_columns(text, check, true);
    return found;
  }
  const bool is_test = path.starts_with("tests/"), is_shader = path.starts_with("shaders/");
  check("lines", static_cast<std::size_t>(std::count(text.begin(), text.end(), '\n')),
        is_test ? kMostLinesOfATest : kMostLines);
  static const std::regex include(R"(#include "(core|proto|server|shaders)/)");
  check("includes of this project",
        static_cast<std::size_t>(
            std::distance(std::sregex_iterator(text.begin(), text.end(), include), {})),
        kMostIncludes);
  check_columns(text, check);
  const std::string code = code_of(text);
  if (!is_shader)
    for (const Class& one : classes_of(code))
      check("methods of " + one.name, one.method_count, kMostMethods);
  for (const Function& function : functions_of(code)) {
    check("lines of `" + function.head + "` in line " + std::to_string(function.line),
          function.line_count, kMostFunctionLines);
    // A shader has no values that may be left out, and structs cost it registers.
    if (!is_test && !is_shader)
      check("parameters of `" + function.head + "` in line " + std::to_string(function.line),
            function.parameter_count,
            allowed(kManyParameters, path, name_in(function.head), kMostParameters));
  }
  return found;
}

TEST(Limits, Hold) {
  const fs::path root = hermite::test::source_root();
  int file_count = 0, web_count = 0;
  for (const char* top : {"core", "proto", "server", "shaders", "tests", "web/src", "web/public"})
    for (const fs::directory_entry& entry : fs::recursive_directory_iterator(root / top)) {
      const std::string extension = entry.path().extension();
      const bool is_native =
          extension == ".h" || extension == ".cpp" || extension == ".comp" || extension == ".glsl";
      const bool is_generated = entry.path().parent_path().filename() == "gen";
      if (is_generated || !(is_native || is_of_the_web(extension))) continue;
      ++(is_native ? file_count : web_count);
      std::ifstream file(entry.path());
      const std::string text{std::istreambuf_iterator<char>(file), {}};
      for (const std::string& offence :
           offences(fs::relative(entry.path(), root).generic_string(), text))
        ADD_FAILURE() << offence;
    }
  EXPECT_GT(file_count, 300) << "is this the source tree? " << root;
  EXPECT_GT(web_count, 200) << "is this the source tree? " << root;
}

TEST(Limits, OffencesAreSeen) {
  const auto count = [](const std::string& text) { return offences("core/a.cpp", text).size(); };
  const auto body = [](int lines) {
    std::string text;
    for (int i = 0; i < lines; ++i) text += "  work(\"}\", '{');  // }\n";
    return text;
  };
  EXPECT_EQ(count("namespace a {\nvoid f() {\n" + body(58) + "}\n}\n"), 0u);
  EXPECT_EQ(count("namespace a {\nvoid f() {\n" + body(59) + "}\n}\n"), 1u);
  EXPECT_EQ(count("class A {\n  int f(int a) const {\n" + body(59) + "  }\n};\n"), 1u);
  EXPECT_EQ(count("const int a[] = {\n" + body(70) + "};\n"), 0u) << "a table is no function";
  EXPECT_EQ(count("int f(int a, std::map<int, int> b, int c, int d, int e) {}\n"), 0u);
  EXPECT_EQ(count("int f(int a, std::map<int, int> b, int c, int d, int e, int f) {}\n"), 1u);
  EXPECT_EQ(offences("core/map/predict.cpp",
                     "void Predictor::run(int a, int b, int c, int d, int e, int f) {}\n")
                .size(),
            0u);
  EXPECT_EQ(offences("core/map/predict.cpp",
                     "void Predictor::run(int a, int b, int c, int d, int e, int f, int g) {}\n")
                .size(),
            1u);
  const auto methods = [](int one_line, int declared) {
    std::string text =
        "class A : public B {\n public:\n  using C = int (*)(int);\n  std::function<void()> d = "
        "e(), f{[](int) {}};\n";
    for (int i = 0; i < one_line; ++i) text += "  int g() const { return h(); }\n";
    for (int i = 0; i < declared; ++i) text += "  std::pair<int, int> i(int a = 0);\n";
    return text + " private:\n  int j_ = 0;\n};\n";
  };
  EXPECT_EQ(count(methods(15, 15)), 0u);
  EXPECT_EQ(count(methods(16, 15)), 1u);
  EXPECT_EQ(count(std::string(400, '\n')), 0u);
  EXPECT_EQ(count(std::string(401, '\n')), 1u);
  EXPECT_EQ(count(std::string(101, 'x')), 1u);
}

TEST(Limits, OffencesOfTheViewerAreSeen) {
  const auto count = [](const std::string& text) { return offences("web/src/a.ts", text).size(); };
  const std::string words(101, 'x');
  EXPECT_EQ(count(words.substr(1)), 0u);
  EXPECT_EQ(count("a\n// " + words + "\n" + words), 2u);
  EXPECT_EQ(count("    '" + words + "\\'s',\n  `" + words + "`\n"), 0u) << "texts for people";
  EXPECT_EQ(count("    text: '" + words + "',\n"), 1u) << "it has room on a line of its own";
  EXPECT_EQ(count("    '" + words + "' + 'x',\n"), 1u);
}

}  // namespace
}  // namespace hermite::limits_test
