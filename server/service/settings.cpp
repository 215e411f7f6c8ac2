#include "server/service/settings.h"

#include <fmt/core.h>

#include <algorithm>
#include <array>
#include <charconv>
#include <string_view>
#include <variant>

#include "server/service/settings_file.h"
#include "server/service/settings_table.h"

namespace hermite::server {

namespace {

constexpr std::string_view kPrefix = "HERMITE_SERVE_";
constexpr std::string_view kConfigVariable = "HERMITE_SERVE_CONFIG";
constexpr std::size_t kMaxTextBytes = 4096;  // a path

using List = std::vector<std::string>;

const SettingRow* find_row(std::string_view key) {
  const auto found = std::find_if(setting_rows().begin(), setting_rows().end(),
                                  [key](const SettingRow& row) { return key == row.key; });
  return found == setting_rows().end() ? nullptr : &*found;
}

Error invalid(const std::string& message) { return {ErrorCode::kInvalidArgument, message}; }

std::string as_text(const List& choices) {
  std::string text;
  for (std::size_t i = 0; i < choices.size(); ++i)
    text += (i == 0 ? "" : i + 1 == choices.size() ? " or " : ", ") + choices[i];
  return text;
}

std::string limits_of(const SettingRow& row) {
  if (!row.choices.empty()) return as_text(row.choices);
  if (std::holds_alternative<bool ServiceOptions::*>(row.field)) return "true or false";
  if (!std::holds_alternative<int ServiceOptions::*>(row.field)) return {};
  return fmt::format("{} to {} {}", row.low, row.high, row.unit);
}

std::string environment_of(const SettingRow& row) {
  std::string name(kPrefix);
  for (const char* c = row.key; *c; ++c)
    name += *c == '-' ? '_' : *c >= 'a' && *c <= 'z' ? static_cast<char>(*c - 'a' + 'A') : *c;
  return name;
}

Error not_allowed(const SettingRow& row, const std::string& value) {
  return invalid(fmt::format("setting {} is '{}', allowed is {}", row.key, value, limits_of(row)));
}

Status check_text(const SettingRow& row, const std::string& text) {
  const auto bad = [](char c) {
    return c == '"' || static_cast<unsigned char>(c) < 0x20 || c == 0x7f;
  };
  if (std::any_of(text.begin(), text.end(), bad))
    return invalid(fmt::format("setting {} has a quotation mark or a control character", row.key));
  if (text.size() > kMaxTextBytes)
    return invalid(fmt::format("setting {} is longer than {} bytes", row.key, kMaxTextBytes));
  if (!row.choices.empty() &&
      std::find(row.choices.begin(), row.choices.end(), text) == row.choices.end())
    return not_allowed(row, text);
  return Done{};
}

Status check_list(const SettingRow& row, const List& values) {
  if (values.size() > static_cast<std::size_t>(kMaxListEntries))
    return invalid(fmt::format("setting {} has {} values, allowed are {}", row.key, values.size(),
                               kMaxListEntries));
  for (const std::string& value : values) {
    if (value.empty() || value.find(',') != std::string::npos)
      return invalid(fmt::format("setting {} has a value '{}': it may not be empty or have a comma",
                                 row.key, value));
    if (Status status = check_text(row, value); !status.ok()) return status;
  }
  return Done{};
}

Status check_number(const SettingRow& row, int number) {
  if (number < row.low || number > row.high) return not_allowed(row, std::to_string(number));
  return Done{};
}

std::string_view trimmed(std::string_view text) {
  const std::size_t from = text.find_first_not_of(" \t\r");
  if (from == std::string_view::npos) return {};
  return text.substr(from, text.find_last_not_of(" \t\r") - from + 1);
}

}  // namespace

std::vector<ServiceSetting> list_settings(const ServiceOptions& options) {
  constexpr std::array<SettingKind, 4> kKinds{SettingKind::kText, SettingKind::kNumber,
                                              SettingKind::kFlag, SettingKind::kList};
  std::vector<ServiceSetting> settings;
  for (const SettingRow& row : setting_rows())
    settings.push_back({row.key, kKinds[row.field.index()], toml_of(row, options), limits_of(row),
                        environment_of(row), row.description});
  return settings;
}

Status apply_setting(ServiceOptions& options, const std::string& key,
                     const std::vector<std::string>& values) {
  const SettingRow* const row = find_row(key);
  if (!row)
    return Error{
        ErrorCode::kNotFound,
        fmt::format("there is no setting '{}'; `hermite serve --print-config` lists them", key)};
  if (const auto* list = std::get_if<List ServiceOptions::*>(&row->field)) {
    if (Status status = check_list(*row, values); !status.ok()) return status;
    options.** list = values;
    return Done{};
  }
  if (values.size() != 1)
    return invalid(fmt::format("setting {} takes one value, given are {}", key, values.size()));
  const std::string& value = values.front();
  if (const auto* text = std::get_if<std::string ServiceOptions::*>(&row->field)) {
    if (Status status = check_text(*row, value); !status.ok()) return status;
    options.** text = value;
  } else if (const auto* flag = std::get_if<bool ServiceOptions::*>(&row->field)) {
    if (value != "true" && value != "false") return not_allowed(*row, value);
    options.** flag = value == "true";
  } else {
    int number = 0;
    const auto [stop, error] = std::from_chars(value.data(), value.data() + value.size(), number);
    if (error != std::errc() || stop != value.data() + value.size())
      return not_allowed(*row, value);
    if (Status status = check_number(*row, number); !status.ok()) return not_allowed(*row, value);
    options.*std::get<int ServiceOptions::*>(row->field) = number;
  }
  return Done{};
}

Status apply_environment(ServiceOptions& options, const char* const* variables) {
  for (; *variables; ++variables) {
    const std::string_view variable = *variables;
    const std::string_view name = variable.substr(0, variable.find('='));
    if (!name.starts_with(kPrefix) || name == kConfigVariable || name.size() == variable.size())
      continue;
    const std::string value(variable.substr(name.size() + 1));
    const auto row = std::find_if(
        setting_rows().begin(), setting_rows().end(),
        [name](const SettingRow& candidate) { return name == environment_of(candidate); });
    if (row == setting_rows().end())
      return invalid(fmt::format(
          "the environment has {}, which is no setting; `hermite serve --print-config` lists them",
          name));
    List values{value};
    if (std::holds_alternative<List ServiceOptions::*>(row->field)) {
      values.clear();
      for (std::size_t from = 0; from < value.size();) {
        const std::size_t end = std::min(value.find(',', from), value.size());
        values.emplace_back(trimmed(std::string_view(value).substr(from, end - from)));
        from = end + 1;
      }
    }
    if (Status status = apply_setting(options, row->key, values); !status.ok())
      return in_context(std::string(name), status.error());
  }
  return Done{};
}

Status check(const ServiceOptions& options) {
  for (const SettingRow& row : setting_rows()) {
    Status status = Done{};
    if (const auto* text = std::get_if<std::string ServiceOptions::*>(&row.field))
      status = check_text(row, options.**text);
    if (const auto* number = std::get_if<int ServiceOptions::*>(&row.field))
      status = check_number(row, options.**number);
    if (const auto* list = std::get_if<List ServiceOptions::*>(&row.field))
      status = check_list(row, options.**list);
    if (!status.ok()) return status;
  }
  if (options.tls_certificate.empty() != options.tls_key.empty())
    return invalid("settings tls-certificate and tls-key go together: one of them is empty");
  return Done{};
}

}  // namespace hermite::server
