// Collects remarks about many frames that may be similar: their number and the first of them in
// full. Plain value, header only.
#pragma once

#include <cstdint>
#include <string>
#include <vector>

namespace hermite::dataset {

class Remarks {
 public:
  explicit Remarks(std::string about) : about_(std::move(about)) {}

  void add(const std::string& remark) {
    if (count_++ < kInFull) first_.push_back(remark);
  }
  std::int64_t count() const { return count_; }

  // Returns no lines if there are no remarks.
  std::vector<std::string> lines() const {
    if (count_ == 0) return {};
    std::vector<std::string> lines{std::to_string(count_) + " " + about_};
    lines.insert(lines.end(), first_.begin(), first_.end());
    return lines;
  }

 private:
  static constexpr std::int64_t kInFull = 20;  // one screen
  const std::string about_;
  std::int64_t count_ = 0;
  std::vector<std::string> first_;
};

}  // namespace hermite::dataset
