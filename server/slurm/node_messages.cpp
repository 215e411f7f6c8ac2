#include "server/slurm/node_messages.h"

#include <array>
#include <nlohmann/json.hpp>
#include <utility>

#include "core/dataset/camera_file.h"
#include "server/store/scan_id.h"

namespace hermite::server {

namespace {

using NodeJson = nlohmann::json;

struct NamedEnd {
  NodeEnd end;
  const char* name;
};
constexpr std::array kNamedEnds = {
    NamedEnd{NodeEnd::kFinished, "finished"}, NamedEnd{NodeEnd::kFailed, "failed"},
    NamedEnd{NodeEnd::kStopped, "stopped"}, NamedEnd{NodeEnd::kNoRoom, "no room"}};

std::string text_of_json(const NodeJson& json) {
  // What stands in a recording may be no UTF-8.
  return json.dump(1, ' ', false, NodeJson::error_handler_t::replace) + "\n";
}

// Reads members of an object, and remembers whether all were there and of the right kind.
class MemberReader {
 public:
  explicit MemberReader(const std::string& text)
      : json_(NodeJson::parse(text, nullptr, false)), is_good_(json_.is_object()) {}
  std::string text(const char* name) {
    const NodeJson* const member = find(name);
    if (member && member->is_string()) return member->get<std::string>();
    is_good_ = false;
    return {};
  }
  std::int64_t number(const char* name) {
    const NodeJson* const member = find(name);
    if (member && member->is_number_integer()) return member->get<std::int64_t>();
    is_good_ = false;
    return 0;
  }
  std::vector<std::string> texts(const char* name) {
    std::vector<std::string> all;
    const NodeJson* const member = find(name);
    is_good_ = is_good_ && member && member->is_array() && member->size() <= kMaxNodeLines;
    if (!is_good_) return all;
    for (const NodeJson& entry : *member) {
      is_good_ = is_good_ && entry.is_string();
      if (entry.is_string()) all.push_back(entry.get<std::string>());
    }
    return all;
  }
  bool is_good() const { return is_good_; }

 private:
  const NodeJson* find(const char* name) const {
    if (!json_.is_object()) return nullptr;
    const auto found = json_.find(name);
    return found == json_.end() ? nullptr : &*found;
  }
  const NodeJson json_;
  bool is_good_;
};

Error no_message(const char* what) {
  return {ErrorCode::kCorruptData, std::string(what) + " is not what this program writes"};
}

}  // namespace

std::string format_order(const NodeOrder& order) {
  const JobRow& job = order.job;
  return text_of_json({{"name", order.name},
                       {"job", job.id},
                       {"token", job.token_id},
                       {"title", job.title},
                       {"source", name_of(job.source)},
                       {"source_id", job.source_id},
                       {"settings", job.settings},
                       {"camera", job.camera},
                       {"scan", job.scan_id},
                       {"logged_frame_count", order.logged_frame_count},
                       {"device", order.device},
                       {"gpu_memory_mb", order.gpu_memory_mb},
                       {"checkpoint_period_ms", order.checkpoint_period_ms},
                       {"min_free_disk_mb", order.min_free_disk_mb}});
}

Result<NodeOrder> parse_order(const std::string& text) {
  MemberReader read(text);
  NodeOrder order;
  order.name = read.text("name");
  order.job.id = read.text("job");
  order.job.token_id = read.text("token");
  order.job.title = read.text("title");
  const std::string source = read.text("source");
  order.job.source = source == name_of(JobSource::kScan) ? JobSource::kScan : JobSource::kUpload;
  order.job.source_id = read.text("source_id");
  order.job.settings = read.text("settings");
  order.job.camera = read.text("camera");
  order.job.scan_id = read.text("scan");
  order.logged_frame_count = static_cast<std::uint64_t>(read.number("logged_frame_count"));
  order.device = read.text("device");
  order.gpu_memory_mb = static_cast<int>(read.number("gpu_memory_mb"));
  order.checkpoint_period_ms = static_cast<int>(read.number("checkpoint_period_ms"));
  order.min_free_disk_mb = static_cast<int>(read.number("min_free_disk_mb"));
  const bool has_ids =
      is_scan_id(order.job.id) && is_scan_id(order.job.source_id) && is_scan_id(order.job.scan_id);
  if (!read.is_good() || !has_ids || source != name_of(order.job.source))
    return no_message("the order for a node");
  return order;
}

std::string format_outcome(const NodeOutcome& outcome) {
  const ScanRow& scan = outcome.scan;
  const char* end = "";
  for (const NamedEnd& named : kNamedEnds)
    if (named.end == outcome.end) end = named.name;
  return text_of_json({{"end", end},
                       {"words", outcome.words},
                       {"lines", outcome.lines},
                       {"peak_memory_bytes", outcome.peak_memory_bytes},
                       {"title", scan.title},
                       {"message", scan.message},
                       {"camera", dataset::format_camera_json({scan.camera})},
                       {"frames_received", scan.frames_received},
                       {"frames_processed", scan.frames_processed},
                       {"frames_dropped", scan.frames_dropped},
                       {"created_at_ms", scan.created_at_ms},
                       {"finished_at_ms", scan.finished_at_ms}});
}

Result<NodeOutcome> parse_outcome(const std::string& text) {
  MemberReader read(text);
  NodeOutcome outcome;
  const std::string end = read.text("end");
  bool is_known = false;
  for (const NamedEnd& named : kNamedEnds)
    if (named.name == end) {
      outcome.end = named.end;
      is_known = true;
    }
  outcome.words = read.text("words");
  outcome.lines = read.texts("lines");
  outcome.peak_memory_bytes = static_cast<std::uint64_t>(read.number("peak_memory_bytes"));
  ScanRow& scan = outcome.scan;
  scan.title = read.text("title");
  scan.message = read.text("message");
  const std::string camera = read.text("camera");
  scan.frames_received = read.number("frames_received");
  scan.frames_processed = read.number("frames_processed");
  scan.frames_dropped = read.number("frames_dropped");
  scan.created_at_ms = read.number("created_at_ms");
  scan.finished_at_ms = read.number("finished_at_ms");
  if (!read.is_good() || !is_known) return no_message("the outcome of a node");
  if (outcome.end != NodeEnd::kFinished) return outcome;
  const Result<dataset::CameraFile> file = dataset::parse_camera_json(camera);
  if (!file.ok()) return in_context("the outcome of a node", file.error());
  scan.camera = file->camera;
  scan.phase = ScanPhase::kFinished;
  return outcome;
}

std::string format_stage(const JobStage& stage) {
  return text_of_json({{"stage", stage.name}, {"done", stage.done}, {"total", stage.total}});
}

Result<JobStage> parse_stage(const std::string& text) {
  MemberReader read(text);
  JobStage stage;
  stage.name = read.text("stage");
  stage.done = read.number("done");
  stage.total = read.number("total");
  if (!read.is_good()) return no_message("the progress of a node");
  return stage;
}

}  // namespace hermite::server
