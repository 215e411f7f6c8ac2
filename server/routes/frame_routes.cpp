#include "server/routes/frame_routes.h"

#include <fmt/core.h>

#include <atomic>
#include <charconv>
#include <chrono>
#include <memory>
#include <nlohmann/json.hpp>
#include <utility>

#include "server/operations/json_text.h"
#include "server/routes/turn.h"
#include "server/scan/arrivals.h"
#include "server/scan/stored_frames.h"

namespace hermite::server {

namespace {

using Json = nlohmann::ordered_json;

constexpr std::int64_t kFrameRetry_ms = 1000;
constexpr std::int64_t kFarthest_mm = 1'000'000;

std::atomic<int> frames_asked = 0;

// Of a running scan only what is on the disk can be read: what is about to be there is an empty
// answer.
std::optional<HttpAnswer> not_there_yet(const LiveScan* scan, const std::string& id,
                                        std::optional<std::uint64_t> sequence) {
  if (!sequence)
    return refused(
        {ErrorCode::kBusy,
         fmt::format("scan {} is running: its frames can be listed when it has ended", id)});
  if (!scan)
    return refused(
        {ErrorCode::kBusy,
         fmt::format("scan {} is being restored: its frames can be looked at in a moment", id)});
  if (*sequence < scan->frames().durable_count()) return std::nullopt;
  HttpAnswer soon;
  soon.status = 204;
  if (*sequence < scan->frames().counts().received) return soon;
  return refused(
      {ErrorCode::kNotFound, fmt::format("there is no frame {} yet: the camera has sent {} so far",
                                         *sequence, scan->frames().counts().received)});
}

// Returns why there are no frames to show, or not this one; std::nullopt if there are.
std::optional<HttpAnswer> no_frames(const HttpWorld& world, const Call& call,
                                    std::optional<std::uint64_t> sequence) {
  if (!call.grant.scan_id.empty())
    return error_answer(
        403, {ErrorCode::kUnauthorized,
              "a share link shows the model of a scan and not what its camera has sent"});
  const Result<ScanRow> row = world.scans.rows().find(call.id);
  if (!row.ok()) return refused(row.error());
  if (row->phase == ScanPhase::kRunning)
    return not_there_yet(world.scans.running(call.id), call.id, sequence);
  if (row->camera.width == 0)
    return refused({ErrorCode::kNotFound,
                    fmt::format("scan {} was imported: no camera has seen it", call.id)});
  return std::nullopt;
}

// Returns an answer that a disk thread makes from what `read` finds in the frame log. Without
// `sequence` it is about all frames.
template <class Read, class Tell>
HttpAnswer later(const HttpWorld& world, const Call& call, std::optional<std::uint64_t> sequence,
                 Read read, Tell tell) {
  if (std::optional<HttpAnswer> none = no_frames(world, call, sequence)) return *std::move(none);
  const auto turn = std::make_shared<Turn>(frames_asked, kMaxFramesAskedAtOnce);
  if (!turn->is_mine())
    return wait_answer(503, "others are looking at frames: try again in a moment", kFrameRetry_ms);
  HttpAnswer answer;
  answer.work = [turn, folder = world.scans.ended_scans().log_folder(call.id), read,
                 tell]() -> HttpAnswer {
    if (!are_frames_kept(folder))
      return error_answer(410,
                          {ErrorCode::kNotFound, "the frames of this scan are not kept any more"});
    const auto found = read(folder);
    return found.ok() ? tell(*found) : refused(found.error());
  };
  return answer;
}

HttpAnswer image_answer(const FrameImage& image) {
  HttpAnswer answer;
  answer.content_type = image.content_type;
  answer.body = image.bytes;
  return answer;
}

std::string in_ms(Arrivals::Clock::duration duration) {
  return std::to_string(std::chrono::duration_cast<std::chrono::milliseconds>(duration).count());
}

// How far the viewers of a running scan are behind, by the clock of this machine.
struct Behind {
  std::optional<Arrivals::Clock::time_point> arrived;  // the frame
  std::optional<Arrivals::Clock::duration> points, surface;

  HttpHeaders headers() const {
    HttpHeaders said;
    if (arrived) said.emplace_back("Frame-Age-Ms", in_ms(Arrivals::Clock::now() - *arrived));
    if (points) said.emplace_back("Points-Delay-Ms", in_ms(*points));
    if (surface) said.emplace_back("Surface-Delay-Ms", in_ms(*surface));
    return said;
  }
};

Behind behind_of(const LiveScan* scan, std::uint64_t sequence) {
  if (!scan) return {};
  const Arrivals& arrivals = scan->display().arrivals();
  return {arrivals.of(sequence), arrivals.points_delay(), arrivals.surface_delay()};
}

template <class Number>
bool is_number(std::string_view text, Number& value) {
  const auto [rest, problem] = std::from_chars(text.data(), text.data() + text.size(), value);
  return problem == std::errc() && rest == text.data() + text.size() && !text.empty();
}

Result<std::uint64_t> frame_in(const Call& call) {
  std::uint64_t sequence = 0;
  if (is_number(call.last_part, sequence)) return sequence;
  return Error{ErrorCode::kInvalidArgument, "the path must end with the number of a frame, from 0"};
}

// Returns an empty optional if no range is requested.
Result<std::optional<DepthRange_mm>> range_in(std::string_view query) {
  if (query.empty()) return std::optional<DepthRange_mm>();
  constexpr std::string_view kFrom = "from_mm=", kTo = "&to_mm=";
  DepthRange_mm range;
  const std::size_t behind_from = query.find(kTo);
  if (!query.starts_with(kFrom) || behind_from == std::string_view::npos ||
      !is_number(query.substr(kFrom.size(), behind_from - kFrom.size()), range.nearest) ||
      !is_number(query.substr(behind_from + kTo.size()), range.farthest) || range.nearest < 0 ||
      range.nearest >= range.farthest || range.farthest > kFarthest_mm)
    return Error{ErrorCode::kInvalidArgument,
                 fmt::format("an image of depth knows ?from_mm=A&to_mm=B with whole numbers, 0 <= "
                             "A < B <= {}, and nothing else",
                             kFarthest_mm)};
  return std::optional(range);
}

// Calls `visit` for each run of consecutive frames with the same `member`, with the number of its
// first frame and of its frames.
template <class Member, class Visit>
void visit_runs(const std::vector<ListedFrame>& frames, Member ListedFrame::*member, Visit visit) {
  for (std::size_t i = 0, begin = 0; i <= frames.size(); ++i) {
    if (i < frames.size() && frames[i].*member == frames[begin].*member) continue;
    if (i > begin) visit(begin, i - begin);
    begin = i;
  }
}

Json fates_json(const std::vector<ListedFrame>& frames) {
  Json runs = Json::array();
  visit_runs(frames, &ListedFrame::fate, [&](std::size_t first, std::size_t count) {
    runs.push_back({{"status", name_of(frames[first].fate)}, {"frames", count}});
  });
  return runs;
}

// Each text once, however many frames there are, and two numbers for each of its runs.
Json reasons_json(const FrameList& list) {
  std::vector<Json> by_number(list.reasons.size() + 1);
  visit_runs(list.frames, &ListedFrame::reason, [&](std::size_t first, std::size_t count) {
    const std::uint16_t number = list.frames[first].reason;
    if (number == pipeline::kNoReason) return;
    Json& reason = by_number[number];
    if (reason.is_null())
      reason = {{"reason", list.reasons.text_of(number)},
                {"first", Json::array()},
                {"frames", Json::array()}};
    reason["first"].push_back(first);
    reason["frames"].push_back(count);
  });
  Json reasons = Json::array();
  for (Json& reason : by_number)
    if (!reason.is_null()) reasons.push_back(std::move(reason));
  return reasons;
}

}  // namespace

HttpAnswer list_scans_frames(const HttpWorld& world, const Call& call) {
  const auto read = [&blobs = world.scans.blobs(), id = call.id](const std::string& folder) {
    return list_frames(folder, blobs, id);
  };
  return later(world, call, std::nullopt, read, [](const FrameList& list) {
    Json times = Json::array();
    for (const ListedFrame& frame : list.frames)
      times.push_back(frame.timestamp_s ? Json(*frame.timestamp_s) : Json());
    return made(json_text(Json{{"width", list.width},
                               {"height", list.height},
                               {"depth_units_per_metre", list.depth_units_per_metre},
                               {"timestamps_s", std::move(times)},
                               {"statuses", fates_json(list.frames)},
                               {"reasons", reasons_json(list)}}));
  });
}

HttpAnswer send_color(const HttpWorld& world, const Call& call) {
  const Result<std::uint64_t> sequence = frame_in(call);
  if (!sequence.ok()) return refused(sequence.error());
  const auto read = [sequence = *sequence](const std::string& folder) {
    return read_color(folder, sequence);
  };
  return later(
      world, call, *sequence, read,
      [behind = behind_of(world.scans.running(call.id), *sequence)](const FrameImage& image) {
        HttpAnswer answer = image_answer(image);
        answer.headers = behind.headers();
        return answer;
      });
}

HttpAnswer send_depth(const HttpWorld& world, const Call& call) {
  const Result<std::uint64_t> sequence = frame_in(call);
  if (!sequence.ok()) return refused(sequence.error());
  const Result<std::optional<DepthRange_mm>> range = range_in(call.request.query);
  if (!range.ok()) return refused(range.error());
  const auto read = [sequence = *sequence, range = *range](const std::string& folder) {
    return read_depth(folder, sequence, range);
  };
  return later(world, call, *sequence, read, [](const DepthView& view) {
    HttpAnswer answer = image_answer(view.image);
    const auto span = [](const DepthRange_mm& mm) {
      return fmt::format("{}-{}", mm.nearest, mm.farthest);
    };
    answer.headers = {
        {"Depth-Shown-Mm", span(view.shown)},
        {"Depth-Measured-Mm", span(view.measured)},
        {"Depth-Valid-Percent", std::to_string(static_cast<int>(100 * view.valid_share))}};
    return answer;
  });
}

HttpAnswer send_raw_depth(const HttpWorld& world, const Call& call) {
  const Result<std::uint64_t> sequence = frame_in(call);
  if (!sequence.ok()) return refused(sequence.error());
  return later(
      world, call, *sequence,
      [sequence = *sequence](const std::string& folder) {
        return read_raw_depth(folder, sequence);
      },
      image_answer);
}

}  // namespace hermite::server
