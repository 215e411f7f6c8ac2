#include "server/exports/export_offer.h"

#include <gmock/gmock.h>
#include <gtest/gtest.h>

#include <fstream>

#include "tests/source_root/source_root.h"

namespace hermite::server {
namespace {

TEST(ExportOffer, TheReadmeHasEveryOneAndNoOther) {
  std::ifstream readme(test::source_root() / "server/README.md");
  std::vector<std::string> written, there;
  bool in_table = false;
  for (std::string line; std::getline(readme, line);) {
    in_table = line == "| format | file | what it is |" || (in_table && line.starts_with("|"));
    if (in_table && line.starts_with("| `"))
      written.push_back(line.substr(0, line.find(" | ", line.find(" | ") + 1)));
  }
  for (const ExportOffer& format : export_offers())
    there.push_back("| `" + std::string(format.name) + "` | " + std::string(format.file));
  EXPECT_THAT(written, testing::ElementsAreArray(there));
}

}  // namespace
}  // namespace hermite::server
