// Where the first inputs of a fuzz target go.
#pragma once

#include <filesystem>
#include <fstream>
#include <stdexcept>
#include <string>
#include <utility>

namespace hermite::fuzz {

class SeedFolder {
 public:
  explicit SeedFolder(std::filesystem::path folder) : folder_(std::move(folder)) {
    std::filesystem::create_directories(folder_);
  }
  void add(const std::string& bytes) {
    std::ofstream file(folder_ / ("seed-" + std::to_string(count_++)), std::ios::binary);
    file << bytes;
    if (!file.flush()) throw std::runtime_error("cannot write a seed into " + folder_.string());
  }

 private:
  std::filesystem::path folder_;
  int count_ = 0;
};

// checkpoint_seeds.cpp
void add_checkpoint_seeds(SeedFolder seeds);
void add_mapping_seeds(SeedFolder seeds);

}  // namespace hermite::fuzz
