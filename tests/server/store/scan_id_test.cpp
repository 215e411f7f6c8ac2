#include "server/store/scan_id.h"

#include <gtest/gtest.h>

#include <set>

namespace hermite::server {
namespace {

TEST(ScanId, NewOnesAreIdsAndDiffer) {
  std::set<std::string> ids;
  for (int i = 0; i < 1000; ++i) {
    const std::string id = new_scan_id();
    EXPECT_TRUE(is_scan_id(id)) << id;
    ids.insert(id);
  }
  EXPECT_EQ(ids.size(), 1000u);
}

TEST(ScanId, EveryLetterOccurs) {
  std::set<char> letters;
  for (int i = 0; i < 200; ++i)
    for (const char c : new_scan_id()) letters.insert(c);
  EXPECT_EQ(letters.size(), 36u);
}

TEST(ScanId, WhatIsNoIdIsRefused) {
  const std::string good(26, 'a');
  EXPECT_TRUE(is_scan_id(good));
  for (const std::string& bad :
       {std::string(), std::string(25, 'a'), std::string(27, 'a'), std::string(25, 'a') + "A",
        std::string(25, 'a') + "/", std::string(25, 'a') + ".", "../" + std::string(23, 'a'),
        std::string(25, 'a') + '\0'})
    EXPECT_FALSE(is_scan_id(bad)) << bad;
}

TEST(ScanId, RandomHexHasTwoDigitsAByte) {
  const std::string hex = random_hex(32);
  EXPECT_EQ(hex.size(), 64u);
  EXPECT_EQ(hex.find_first_not_of("0123456789abcdef"), std::string::npos);
  EXPECT_NE(hex, random_hex(32));
}

}  // namespace
}  // namespace hermite::server
