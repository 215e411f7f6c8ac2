#include "server/routes/edit_routes.h"

#include <fmt/core.h>

#include <memory>
#include <nlohmann/json.hpp>
#include <optional>
#include <utility>

#include "server/exports/exports.h"
#include "server/exports/scan_edits_file.h"
#include "server/operations/json_text.h"
#include "server/routes/gathered_body.h"
#include "server/routes/scan_routes.h"

namespace hermite::server {

namespace {

using Json = nlohmann::ordered_json;

HttpAnswer changed_meanwhile(const edit::ScanEdits& now) {
  HttpAnswer answer = error_answer(
      409, {ErrorCode::kBusy, fmt::format("the edits have version {} by now: somebody has changed "
                                          "them meanwhile, and they stay as they are",
                                          now.version)});
  Json json = Json::parse(answer.body);
  json["edits"] = Json::parse(edit::format_scan_edits(now));
  answer.body = json_text(json);
  return answer;
}

class EditsBody : public GatheredBody {
 public:
  using GatheredBody::GatheredBody;

  void close(bool complete) override {
    if (complete) edits_ = edit::parse_scan_edits(body_);
  }
  HttpAnswer answer() override {
    if (!edits_.ok()) return refused(edits_.error());
    const Result<edit::ScanEdits> now = world_.exports.change_edits(scan_id_, *edits_);
    if (!now.ok()) return refused(now.error());
    return now->edits == edits_->edits ? made(edit::format_scan_edits(*now))
                                       : changed_meanwhile(*now);
  }

 private:
  Result<edit::ScanEdits> edits_ =
      Error{ErrorCode::kInvalidArgument, "the body did not come whole"};
};

}  // namespace

HttpAnswer show_edits(const HttpWorld& world, const Call& call) {
  const Result<edit::ScanEdits> edits = world.exports.edits(call.id);
  return edits.ok() ? made(edit::format_scan_edits(*edits)) : refused(edits.error());
}

HttpAnswer change_edits(const HttpWorld& world, const Call& call) {
  if (std::optional<HttpAnswer> no = keep_out(world, call)) return *std::move(no);
  if (std::optional<HttpAnswer> no = wrong_size(call, kMaxEdits_bytes)) return *std::move(no);
  return received_into(std::make_shared<EditsBody>(world, call));
}

}  // namespace hermite::server
