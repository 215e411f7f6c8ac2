#include "core/source/open_sequence.h"

#include <gmock/gmock.h>
#include <gtest/gtest.h>

#include <filesystem>

#include "tests/core/dataset/temp_folder.h"

namespace hermite::source::open_sequence_test {
namespace {

using testing::HasSubstr;

const std::string kRoom = "synthetic:frames=4,width=80,height=64";

std::string error_of(const std::string& source) {
  const auto sequence = open_sequence(source);
  return sequence.ok() ? "opened" : sequence.error().message;
}

TEST(OpenSequence, UnknownSourcesAreErrors) {
  const dataset::TempFolder folder;
  EXPECT_THAT(error_of(folder.path()), HasSubstr("is no recording we know"));
  EXPECT_THAT(error_of(folder.path("nowhere")),
              HasSubstr("is neither a file, a folder nor synthetic"));
  EXPECT_THAT(error_of(""), HasSubstr("is neither a file, a folder nor synthetic"));
  EXPECT_THAT(error_of("synthetics"), HasSubstr("is neither a file, a folder nor synthetic"));
  EXPECT_THAT(error_of(std::string(100'000, 'x')), HasSubstr("is neither a file"));
}

TEST(OpenSequence, NoiseIsAskedForBehindTheSource) {
  const auto clean = open_sequence(kRoom),
             noisy = open_sequence(kRoom + "+noise=gaussian,sigma_mm=6,seed=2");
  ASSERT_TRUE(noisy.ok()) << noisy.error().message;
  EXPECT_EQ((*noisy)->name(), (*clean)->name());
  EXPECT_NE((*noisy)->read(1)->depth, (*clean)->read(1)->depth);
  EXPECT_EQ((*noisy)->read(1)->color_bytes, (*clean)->read(1)->color_bytes);
  EXPECT_THAT(error_of(kRoom + "+noise=pink"), HasSubstr("noise is \"pink\""));
  EXPECT_THAT(error_of("nowhere+noise=kinect"), HasSubstr("is neither a file"));
}

TEST(OpenSequence, SuffixesAreTakenOffASource) {
  EXPECT_EQ(
      source_without_suffixes("synthetic:scene=loop+noise=kinect,seed=1+covered=3:4+missing=5:6"),
      "synthetic:scene=loop");
  EXPECT_EQ(source_without_suffixes("synthetic"), "synthetic");
  EXPECT_EQ(source_without_suffixes("a+b"), "a+b");
  const dataset::TempFolder folder;
  std::filesystem::create_directory(folder.path("x+noise=kinect"));
  EXPECT_EQ(source_without_suffixes(folder.path("x+noise=kinect") + "+covered=0:1"),
            folder.path("x+noise=kinect"))
      << "a folder of that name comes first";
}

}  // namespace
}  // namespace hermite::source::open_sequence_test
