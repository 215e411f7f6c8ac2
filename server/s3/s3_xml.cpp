#include "server/s3/s3_xml.h"

#include <boost/property_tree/ptree.hpp>
#include <boost/property_tree/xml_parser.hpp>
#include <charconv>
#include <optional>
#include <sstream>

namespace hermite::server {

namespace {

namespace pt = boost::property_tree;

constexpr int kMaxDepth = 16;  // of elements in each other; the parser calls itself for each

bool is_deep(const std::string& xml) {
  int depth = 0;
  for (std::size_t at = xml.find('<'); at != std::string::npos && at + 1 < xml.size();
       at = xml.find('<', at + 1)) {
    if (xml[at + 1] == '/')
      --depth;
    else if (xml[at + 1] != '?' && xml[at + 1] != '!' && ++depth > kMaxDepth)
      return true;
  }
  return false;
}

std::optional<pt::ptree> parse(const std::string& xml) try {
  if (is_deep(xml)) return std::nullopt;
  std::istringstream stream(xml);
  pt::ptree tree;
  pt::read_xml(stream, tree);
  return tree;
} catch (const pt::xml_parser_error&) {
  return std::nullopt;
}

Error corrupt(const std::string& message) {
  return {ErrorCode::kCorruptData, "S3's list of objects " + message};
}

Result<S3Object> object_of(const pt::ptree& contents) {
  S3Object object{contents.get<std::string>("Key", ""), 0,
                  unquoted_etag(contents.get<std::string>("ETag", ""))};
  const std::string size = contents.get<std::string>("Size", "");
  const auto [stop, error] =
      std::from_chars(size.data(), size.data() + size.size(), object.size_bytes);
  if (object.key.empty() || size.empty() || error != std::errc() ||
      stop != size.data() + size.size())
    return corrupt("has an entry without a key or a size");
  return object;
}

}  // namespace

std::string unquoted_etag(const std::string& etag) {
  return etag.size() >= 2 && etag.front() == '"' && etag.back() == '"'
             ? etag.substr(1, etag.size() - 2)
             : etag;
}

S3ErrorBody parse_s3_error(const std::string& xml) {
  if (xml.find("<Error") == std::string::npos) return {};
  const std::optional<pt::ptree> tree = parse(xml);
  if (!tree) return {};
  return {tree->get<std::string>("Error.Code", ""), tree->get<std::string>("Error.Message", "")};
}

Result<S3Page> parse_s3_page(const std::string& xml) {
  const std::optional<pt::ptree> tree = parse(xml);
  const auto root = tree ? tree->get_child_optional("ListBucketResult") : boost::none;
  if (!root) return corrupt("is not one");
  S3Page page;
  for (const auto& [name, child] : *root) {
    if (name != "Contents") continue;
    Result<S3Object> object = object_of(child);
    if (!object.ok()) return object.error();
    page.objects.push_back(*std::move(object));
  }
  const std::string truncated = root->get<std::string>("IsTruncated", "");
  if (truncated != "true" && truncated != "false")
    return corrupt("does not say whether it is complete");
  if (truncated == "true") page.next = root->get<std::string>("NextContinuationToken", "");
  if (truncated == "true" && page.next.empty())
    return corrupt("is cut off and does not say how to go on");
  return page;
}

}  // namespace hermite::server
