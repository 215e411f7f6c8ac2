// Rows for tests of the store and of what uses it. Header only.
#pragma once

#include <gtest/gtest.h>

#include <cstdint>
#include <string>
#include <vector>

#include "core/base/result.h"
#include "core/digest/sha256.h"
#include "server/store/scan_id.h"
#include "server/store/store.h"

namespace hermite::test {

inline server::ScanRow scan_row(const std::string& id, std::int64_t created_at_ms = 1) {
  server::ScanRow row;
  row.id = id;
  row.title = "title of " + id + " 'quoted'; -- \xC3\xA4\xE2\x82\xAC";
  row.camera = {640, 480, 525.5, 524.5, 319.5, 239.5, 5000};
  row.created_at_ms = created_at_ms;
  return row;
}

inline server::TokenRow token_row(const std::string& id, std::int64_t created_at_ms = 1) {
  server::TokenRow row;
  row.id = id;
  row.secret_sha256 = digest::sha256("secret of " + id);
  row.name = "name of " + id;
  row.scopes = {true, true, false};
  row.created_at_ms = created_at_ms;
  return row;
}

inline server::TokenRow admin_row(const std::string& id) {
  server::TokenRow row = token_row(id);
  row.scopes.admin = true;
  return row;
}

inline server::TokenRow share_row(const std::string& id, const std::string& scan_id) {
  server::TokenRow row = token_row(id);
  row.scopes = {true, false, false};
  row.scan_id = scan_id;
  return row;
}

inline server::JobRow job_row(int priority = 0, std::int64_t created_at_ms = 0,
                              server::JobState state = server::JobState::kQueued) {
  server::JobRow row;
  row.id = server::new_scan_id();
  row.token_id = "t";
  row.title = "a 'title'";
  row.source_id = row.id;
  row.priority = priority;
  row.state = state;
  row.created_at_ms = created_at_ms;
  return row;
}

template <class Row>
std::vector<std::string> ids_of(const Result<std::vector<Row>>& rows) {
  std::vector<std::string> ids;
  EXPECT_TRUE(rows.ok());
  if (rows.ok())
    for (const Row& row : *rows) ids.push_back(row.id);
  return ids;
}

}  // namespace hermite::test
