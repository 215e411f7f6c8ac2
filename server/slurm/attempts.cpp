#include "server/slurm/attempts.h"

#include <fmt/core.h>
#include <sys/stat.h>

#include <algorithm>
#include <cerrno>
#include <filesystem>
#include <fstream>
#include <system_error>
#include <utility>

#include "core/base/sync_path.h"
#include "core/dataset/text_file.h"
#include "core/output/ply.h"
#include "server/scan/checkpoint_file.h"
#include "server/slurm/slurm_text.h"
#include "server/store/errno_error.h"
#include "server/store/scan_id.h"

namespace hermite::server {

namespace {

namespace fs = std::filesystem;

constexpr const char *kAttemptPrefix = "attempt-", *kRunPrefix = "run-", *kNumberName = "number",
                     *kClosedName = "closed";
constexpr std::streamoff kLastWordsBytes = 200;  // as clean_title() leaves
constexpr std::size_t kNameDigits = 8;           // of the random part of a name

// Numbers behind a prefix in the names of folders, ascending.
std::vector<int> numbers_in(const std::string& folder, const std::string& prefix) {
  std::vector<int> numbers;
  std::error_code error;
  for (fs::directory_iterator entry(folder, error), end; !error && entry != end;
       entry.increment(error)) {
    const std::string name = entry->path().filename();
    if (!name.starts_with(prefix)) continue;
    const std::optional<std::int64_t> number =
        dataset::parse_index(std::string_view(name).substr(prefix.size()));
    if (number && *number < 1'000'000) numbers.push_back(static_cast<int>(*number));
  }
  std::sort(numbers.begin(), numbers.end());
  return numbers;
}

std::string attempt_folder_of(const std::string& job_folder, int number) {
  return fmt::format("{}/{}{}", job_folder, kAttemptPrefix, number);
}

Status make_folder(const std::string& folder) {
  if (mkdir(folder.c_str(), 0700) != 0 && errno != EEXIST) return errno_error("creating " + folder);
  return Done{};
}

template <class Place>
Status place_files(const std::string& from, const std::string& to, Place place) {
  std::error_code error;
  fs::directory_iterator entry(from, error);
  if (error == std::errc::no_such_file_or_directory)
    return Error{ErrorCode::kNotFound, "there is no folder " + from};
  if (Status made = make_folder(to); !made.ok()) return made;
  for (const fs::directory_iterator end; !error && entry != end; entry.increment(error)) {
    std::error_code gone;
    if (!fs::is_regular_file(entry->symlink_status(gone))) continue;
    const std::string name = entry->path().filename();
    if (Status placed = place(from + "/" + name, to + "/" + name); !placed.ok()) return placed;
  }
  if (error) return Error{ErrorCode::kIo, fmt::format("reading {}: {}", from, error.message())};
  return sync_path(to);
}

Status copy_one(const std::string& from, const std::string& to) {
  std::error_code error;
  fs::copy_file(from, to, fs::copy_options::overwrite_existing, error);
  if (error) return Error{ErrorCode::kIo, fmt::format("copying {}: {}", from, error.message())};
  return sync_path(to);
}

std::optional<Attempt> attempt_in(const std::string& job_folder, int number) {
  Attempt attempt{attempt_folder_of(job_folder, number), number, {}};
  const Result<NodeOrder> order = read_order(attempt.folder);
  if (!order.ok()) return std::nullopt;
  attempt.name = order->name;
  return attempt;
}

}  // namespace

std::string run_folder(const std::string& attempt_folder, int run) {
  return fmt::format("{}/{}{}", attempt_folder, kRunPrefix, run);
}

// The order comes last: an attempt without one was never submitted, and is not used.
Result<Attempt> create_attempt(const std::string& job_folder, NodeOrder order,
                               const OrderSource& source) {
  const std::vector<int> numbers = numbers_in(job_folder, kAttemptPrefix);
  Attempt attempt;
  attempt.number = numbers.empty() ? 1 : numbers.back() + 1;
  attempt.folder = attempt_folder_of(job_folder, attempt.number);
  attempt.name = fmt::format("hermite-{}-{}-{}", order.job.id, attempt.number,
                             new_scan_id().substr(0, kNameDigits));
  order.name = attempt.name;
  for (const std::string& folder : {job_folder, attempt.folder})
    if (Status made = make_folder(folder); !made.ok()) return made.error();
  const Status placed = order.job.source == JobSource::kScan
                            ? link_files(source.path, attempt.folder + "/log")
                            : link_or_copy(source.path, attempt.folder + "/recording");
  if (!placed.ok()) return placed.error();
  for (const auto& [name, text] :
       {std::pair(kScriptName, batch_script(source.program, attempt.folder)),
        std::pair(kOrderName, format_order(order))})
    if (Status written = output::write_file_atomically(attempt.folder + "/" + name, text);
        !written.ok())
      return written.error();
  return attempt;
}

std::vector<Attempt> attempts_of(const std::string& job_folder) {
  std::vector<Attempt> attempts;
  for (const int number : numbers_in(job_folder, kAttemptPrefix)) {
    const std::optional<Attempt> attempt = attempt_in(job_folder, number);
    attempts.push_back(
        attempt.value_or(Attempt{attempt_folder_of(job_folder, number), number, {}}));
  }
  return attempts;
}

std::optional<Attempt> open_attempt(const std::string& job_folder) {
  const std::vector<Attempt> attempts = attempts_of(job_folder);
  if (attempts.empty() || attempts.back().name.empty() || is_closed(attempts.back().folder))
    return std::nullopt;
  return attempts.back();
}

bool is_closed(const std::string& attempt_folder) {
  std::error_code error;
  return fs::exists(attempt_folder + "/" + kClosedName, error) ||
         !fs::exists(attempt_folder, error);
}

Status close_attempt(const std::string& attempt_folder) {
  return output::write_file_atomically(attempt_folder + "/" + kClosedName, "");
}

std::string number_of(const Attempt& attempt) {
  const Result<std::string> text =
      dataset::read_text_file(attempt.folder + "/" + kNumberName, kMaxNodeMessageBytes);
  if (!text.ok()) return {};
  const Result<std::string> number = parse_job_number(*text);
  return number.ok() ? *number : std::string();
}

Status keep_number(const Attempt& attempt, const std::string& number) {
  return output::write_file_atomically(attempt.folder + "/" + kNumberName, number + "\n");
}

std::vector<std::string> jobs_in(const std::string& folder) {
  std::vector<std::string> jobs;
  std::error_code error;
  for (fs::directory_iterator entry(folder, error), end; !error && entry != end;
       entry.increment(error))
    if (std::string name = entry->path().filename(); is_scan_id(name))
      jobs.push_back(std::move(name));
  return jobs;
}

int newest_run(const std::string& attempt_folder) {
  const std::vector<int> runs = numbers_in(attempt_folder, kRunPrefix);
  return runs.empty() ? -1 : runs.back();
}

Result<NodeOrder> read_order(const std::string& attempt_folder) {
  const Result<std::string> text =
      dataset::read_text_file(attempt_folder + "/" + kOrderName, kMaxNodeMessageBytes);
  if (!text.ok()) return text.error();
  return parse_order(*text);
}

Result<NodeOutcome> read_outcome(const std::string& attempt_folder, int run) {
  const Result<std::string> text = dataset::read_text_file(
      run_folder(attempt_folder, run) + "/" + kOutcomeName, kMaxNodeMessageBytes);
  if (!text.ok()) return text.error();
  return parse_outcome(*text);
}

Result<JobStage> read_progress(const std::string& attempt_folder, int run) {
  const Result<std::string> text = dataset::read_text_file(
      run_folder(attempt_folder, run) + "/" + kProgressName, kMaxNodeMessageBytes);
  if (!text.ok()) return text.error();
  return parse_stage(*text);
}

std::string last_words(const std::string& attempt_folder) {
  std::ifstream file(attempt_folder + "/" + kOutputName, std::ios::binary | std::ios::ate);
  const std::streamoff length = file.tellg();
  if (length <= 0) return {};
  const std::streamoff from = std::max<std::streamoff>(0, length - kLastWordsBytes);
  std::string text(static_cast<std::size_t>(length - from), '\0');
  file.seekg(from);
  file.read(text.data(), static_cast<std::streamsize>(text.size()));
  text.resize(static_cast<std::size_t>(std::max<std::streamsize>(file.gcount(), 0)));
  while (!text.empty() && text.back() == '\n') text.pop_back();
  return text;
}

std::optional<std::string> run_to_go_on_from(const std::string& attempt_folder, int run,
                                             const std::string& scan_id) {
  const fs::path folder(attempt_folder);
  const std::string job_folder = folder.parent_path(), name = folder.filename();
  std::vector<std::string> earlier;  // the newest last
  for (const Attempt& attempt : attempts_of(job_folder)) {
    const bool is_own = fs::path(attempt.folder).filename() == name;
    for (const int number : numbers_in(attempt.folder, kRunPrefix))
      if (!is_own || number < run) earlier.push_back(run_folder(attempt.folder, number));
    if (is_own) break;
  }
  for (auto candidate = earlier.rbegin(); candidate != earlier.rend(); ++candidate) {
    std::error_code error;
    const std::string scan = *candidate + "/scans/" + scan_id;
    if (fs::exists(scan + "/" + kCheckpointName, error) && fs::exists(scan + "/log", error))
      return *candidate;
  }
  return std::nullopt;
}

Status link_or_copy(const std::string& from, const std::string& to) {
  std::error_code error;
  fs::remove(to, error);
  fs::create_hard_link(from, to, error);
  return error ? copy_one(from, to) : Status(Done{});
}

Status link_files(const std::string& from, const std::string& to) {
  return place_files(from, to, link_or_copy);
}

Status copy_files(const std::string& from, const std::string& to) {
  return place_files(from, to, copy_one);
}

}  // namespace hermite::server
