#include "server/service/settings_file.h"

#include <fmt/core.h>
#include <toml++/toml.h>

#include <optional>
#include <sstream>
#include <type_traits>
#include <variant>
#include <vector>

#include "server/service/settings.h"

namespace hermite::server {

namespace {

constexpr std::size_t kQuotedBytes = 80;  // of a line with a mistake

Error in_line(const std::string& text, const toml::source_region& where, const Error& error) {
  std::istringstream lines(text);
  std::string line;
  for (toml::source_index number = 0; number < where.begin.line; ++number)
    std::getline(lines, line);
  if (!line.empty() && line.back() == '\r') line.pop_back();
  return in_context(fmt::format("line {}, {}{}", where.begin.line, line.substr(0, kQuotedBytes),
                                line.size() > kQuotedBytes ? "..." : ""),
                    {ErrorCode::kInvalidArgument, error.message});
}

std::optional<std::string> scalar_of(const toml::node& node) {
  if (const auto* text = node.as_string()) return text->get();
  if (const auto* number = node.as_integer()) return std::to_string(number->get());
  if (const auto* flag = node.as_boolean()) return flag->get() ? "true" : "false";
  return std::nullopt;
}

Status apply_node(ServiceOptions& options, const std::string& key, const toml::node& node) {
  if (node.is_table())
    return Error{ErrorCode::kInvalidArgument, "there are no tables in this file"};
  std::vector<std::optional<std::string>> values;
  if (const auto* array = node.as_array())
    for (const toml::node& entry : *array)
      values.push_back(entry.is_string() ? scalar_of(entry) : std::nullopt);
  else
    values.push_back(scalar_of(node));
  std::vector<std::string> texts;
  for (const std::optional<std::string>& value : values) {
    if (!value)
      return Error{ErrorCode::kInvalidArgument,
                   "a value is a \"string\", a whole number, true, false or [\"a\", \"b\"]"};
    texts.push_back(*value);
  }
  return apply_setting(options, key, texts);
}

template <class Value>
std::string as_toml(const Value& value) {
  std::ostringstream text;
  // As a plain string in any case: 'literal' strings are less known.
  text << toml::toml_formatter(
      value, toml::toml_formatter::default_flags & ~toml::format_flags::allow_literal_strings);
  return text.str();
}

}  // namespace

Status apply_config(ServiceOptions& options, const std::string& text) {
  if (text.size() > kMaxConfigBytes)
    return Error{ErrorCode::kInvalidArgument,
                 fmt::format("the file is longer than {} bytes", kMaxConfigBytes)};
  try {
    const toml::table settings = toml::parse(text);
    for (const auto& [key, node] : settings)
      if (Status status = apply_node(options, std::string(key.str()), node); !status.ok())
        return in_line(text, key.source(), status.error());
  } catch (const toml::parse_error& error) {
    return in_line(text, error.source(),
                   {ErrorCode::kInvalidArgument, std::string(error.description())});
  }
  return Done{};
}

std::string toml_of(const SettingRow& row, const ServiceOptions& options) {
  return std::visit(
      [&options](const auto field) {
        const auto& value = options.*field;
        if constexpr (std::is_same_v<decltype(value), const std::vector<std::string>&>) {
          std::string list;
          for (const std::string& entry : value)
            list += (list.empty() ? "" : ", ") + as_toml(toml::value(entry));
          return fmt::format("[{}]", list);
        } else {
          return as_toml(toml::value(value));
        }
      },
      row.field);
}

std::string format_config(const ServiceOptions& options, const ServiceOptions& defaults) {
  std::string text =
      "# Settings of `hermite serve`, as they are now. A flag (--key VALUE) goes before the "
      "environment, the environment before the file\n"
      "# (--config FILE), the file before the default.\n";
  const std::vector<ServiceSetting> standard = list_settings(defaults);
  const std::vector<ServiceSetting> settings = list_settings(options);
  for (std::size_t i = 0; i < settings.size(); ++i) {
    const ServiceSetting& setting = settings[i];
    text += fmt::format("\n# {}\n# default: {}", setting.description, standard[i].value);
    if (!setting.limits.empty()) text += "; allowed: " + setting.limits;
    text += fmt::format("; environment: {}\n{} = {}\n", setting.environment, setting.key,
                        setting.value);
  }
  return text;
}

}  // namespace hermite::server
