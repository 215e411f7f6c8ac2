#include "server/access/rate_limit.h"

#include <algorithm>
#include <cmath>
#include <cstdlib>

#include "core/base/check.h"

namespace hermite::server {

namespace {
// In events: sums of fractions must not exceed the promised time.
constexpr double kRounding = 1e-6;
}  // namespace

RateLimit::RateLimit(double per_second, double burst) : per_ms_(per_second / 1000), burst_(burst) {
  CHECK(per_second > 0 && burst >= 1, "a rate that never allows anything");
}

RateLimit::Allowance RateLimit::refilled(const Allowance& allowance, std::int64_t now_ms) const {
  const auto passed_ms = static_cast<double>(std::max<std::int64_t>(now_ms - allowance.at_ms, 0));
  return {std::min(burst_, allowance.left + passed_ms * per_ms_), now_ms};
}

// An address whose allowance is full again needs no entry. Not done for every event, since it looks
// at all entries.
void RateLimit::forget_idle(std::int64_t now_ms) {
  constexpr std::int64_t kPause_ms = 1000;
  if (std::abs(now_ms - forgotten_at_ms_) < kPause_ms) return;
  forgotten_at_ms_ = now_ms;
  std::erase_if(allowances_,
                [&](const auto& entry) { return refilled(entry.second, now_ms).left >= burst_; });
}

std::int64_t RateLimit::take(const std::string& address, std::int64_t now_ms) {
  auto found = allowances_.find(address);
  if (found == allowances_.end()) {
    if (allowances_.size() >= kMaxLimitedAddresses) forget_idle(now_ms);
    const bool room = allowances_.size() < kMaxLimitedAddresses;
    found =
        allowances_.try_emplace(room ? address : std::string(), Allowance{burst_, now_ms}).first;
  }
  Allowance& allowance = found->second;
  allowance = refilled(allowance, now_ms);
  const double missing = 1 - kRounding - allowance.left;
  if (missing > 0)
    return std::max<std::int64_t>(1, static_cast<std::int64_t>(std::ceil(missing / per_ms_)));
  allowance.left = std::max(0.0, allowance.left - 1);
  return 0;
}

bool CountLimit::enter(const std::string& address) {
  if (count_ >= in_all_) return false;
  int& count = counts_[address];
  if (count >= per_address_ && !address.empty()) return false;
  ++count;
  ++count_;
  return true;
}

void CountLimit::leave(const std::string& address) {
  const auto found = counts_.find(address);
  CHECK(found != counts_.end(), "left without having entered");
  --count_;
  if (--found->second == 0) counts_.erase(found);
}

Result<std::unique_ptr<ShareCount::Place>> ShareCount::enter(const std::string& token_id,
                                                             bool is_admin,
                                                             const std::string& things) {
  const auto own = counts_.find(token_id);
  const Taken taken{count_, own == counts_.end() ? 0 : own->second};
  if (Status status = check_share(share_, taken, is_admin, things); !status.ok())
    return status.error();
  ++count_;
  ++counts_[token_id];
  return std::make_unique<Place>(*this, token_id);
}

void ShareCount::leave(const std::string& token_id) {
  const auto own = counts_.find(token_id);
  CHECK(own != counts_.end(), "left without having entered");
  --count_;
  if (--own->second == 0) counts_.erase(own);
}

}  // namespace hermite::server
