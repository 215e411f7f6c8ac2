#include "server/disk/log_readers.h"

#include <algorithm>
#include <utility>
#include <vector>

#include "core/base/check.h"

namespace hermite::server {

void LogReaders::read(const std::string& scan_id, std::function<Opened()> open,
                      std::function<void(Opened)> then) {
  CHECK(!wanted_.contains(scan_id), "a log is read once");
  wanted_[scan_id] = std::make_shared<Wanted>(Wanted{std::move(open), std::move(then)});
  line_.push_back(scan_id);
  go_on();
}

void LogReaders::drop(const std::string& scan_id) {
  wanted_.erase(scan_id);
  std::erase(line_, scan_id);
  wake([&scan_id](const Waiting& one) { return one.scan_id == scan_id; });
}

void LogReaders::go_on() {
  while (!stopping_ && !line_.empty() && reading_count_ < kMaxLogsRead && room_(reading_count_)) {
    const std::string scan_id = line_.front();
    line_.pop_front();
    ++reading_count_;
    threads_.background([this, scan_id, wanted = wanted_.at(scan_id)] {
      // Posted functions must be copyable, but an open log is not.
      auto opened = std::make_shared<Opened>(wanted->open());
      threads_.network(
          [this, scan_id, wanted, opened] { was_read(scan_id, wanted, std::move(*opened)); });
    });
  }
}

void LogReaders::was_read(const std::string& scan_id, const std::shared_ptr<Wanted>& wanted,
                          Opened opened) {
  --reading_count_;
  const auto found = wanted_.find(scan_id);
  // Otherwise it was dropped meanwhile, and perhaps requested again, or it is left to the next
  // server.
  if (!stopping_ && found != wanted_.end() && found->second == wanted) {
    wanted_.erase(found);
    wanted->then(std::move(opened));
    wake([&scan_id](const Waiting& one) { return one.scan_id == scan_id; });
  }
  go_on();
}

void LogReaders::stop() {
  stopping_ = true;
  line_.clear();
  wake([](const Waiting&) { return true; });
}

LogReaders::Ticket LogReaders::when_read(const std::string& scan_id, std::function<void()> then) {
  const Ticket ticket = next_ticket_++;
  waiting_[ticket] = {scan_id, Clock::now(), std::move(then)};
  return ticket;
}

void LogReaders::tick(Clock::time_point now) {
  wake([now](const Waiting& one) { return now - one.since >= kReadPatience; });
}

// The callbacks may add or remove waiting clients.
template <class Which>
void LogReaders::wake(Which which) {
  std::vector<Ticket> woken;
  for (const auto& [ticket, one] : waiting_)
    if (which(one)) woken.push_back(ticket);
  for (const Ticket ticket : woken) {
    auto one = waiting_.extract(ticket);
    if (!one.empty()) one.mapped().then();
  }
}

}  // namespace hermite::server
