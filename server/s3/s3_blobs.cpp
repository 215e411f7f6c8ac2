#include "server/s3/s3_blobs.h"

#include <fmt/core.h>
#include <openssl/evp.h>

#include <algorithm>
#include <array>
#include <cctype>
#include <utility>

#include "core/base/check.h"
#include "core/digest/sha256.h"
#include "server/net/base64.h"
#include "server/store/scan_id.h"

namespace hermite::server {

namespace {

// Whose checksums are kept in memory.
constexpr std::size_t kMaxObjectsKnown = 256;
// For those who read an object piece by piece.
constexpr std::size_t kMaxBlocksKept_bytes = 64 * 1024 * 1024;
// Blocks; who asks for more does not read piece by piece.
constexpr std::size_t kMaxSpanKept = 2;
// While the object is being replaced, or its bytes are wrong.
constexpr int kReadAttempts = 12;
constexpr std::size_t kMaxPage_bytes = 4 * 1024 * 1024;  // of a list of a thousand keys
constexpr int kMaxPages = 100'000;
constexpr const char *kOwnerKey = "owner", *kCheckKey = "check/probe";

std::string md5(std::string_view bytes) {
  std::array<unsigned char, EVP_MAX_MD_SIZE> digest{};
  unsigned size = 0;
  CHECK(EVP_Digest(bytes.data(), bytes.size(), digest.data(), &size, EVP_md5(), nullptr) == 1,
        "OpenSSL has no MD5");
  return {reinterpret_cast<const char*>(digest.data()), size};
}

std::string key_of(const std::string& scan_id, const std::string& name) {
  CHECK(is_scan_id(scan_id), "a key from something that is no scan id");
  CHECK(is_blob_name(name), "a key from something that is no name of a blob");
  return scan_id + "/" + name;
}

// Of [a-z0-9-], as the interface wants it.
std::string version_of(const std::string& etag) {
  std::string version;
  for (const char c : unquoted_etag(etag))
    version +=
        std::isalnum(static_cast<unsigned char>(c)) ? static_cast<char>(std::tolower(c)) : '-';
  return version;
}

std::string header(const S3Answer& answer, const char* name) {
  const auto found = answer.headers.find(name);
  return found == answer.headers.end() ? "" : found->second;
}

bool is_missing(const S3Answer& answer) {
  return answer.status == 404 && parse_s3_error(answer.body).code != "NoSuchBucket";
}

// The MD5 of what was stored, unless the server encrypts with keys of its own: then it is something
// else.
bool is_other_md5(const S3Answer& answer, const std::string& md5_hex) {
  const std::string etag = unquoted_etag(header(answer, "etag"));
  const bool encrypted = header(answer, "x-amz-server-side-encryption").rfind("aws:kms", 0) == 0 ||
                         answer.headers.contains("x-amz-server-side-encryption-customer-algorithm");
  return !encrypted && etag != md5_hex;
}

Error wrong_bytes(const std::string& key, const std::string& message) {
  return {ErrorCode::kIo, fmt::format("{} in S3: {}", key, message)};
}

Error not_there(const std::string& key) {
  return {ErrorCode::kNotFound, fmt::format("there is no {} in S3", key)};
}

}  // namespace

std::string S3Blobs::address() const {
  return text_of(S3Location{client_.options().bucket, client_.options().prefix});
}

Status S3Blobs::availability() { return client_.availability(); }

// Also called when the change has been made: what was read meanwhile may be old.
void S3Blobs::forget(const std::string& key) {
  const std::lock_guard lock(mutex_);
  ++change_count_;
  objects_.erase(key);
  blocks_.remove_if([&key](const Block& block) { return block.key == key; });
}

Result<StoredBlob> S3Blobs::put_key(const std::string& key, const std::string& bytes) {
  if (bytes.size() > kMaxS3Put_bytes)
    return Error{ErrorCode::kTooLarge,
                 fmt::format("{} has {} bytes, S3 takes {}", key, bytes.size(), kMaxS3Put_bytes)};
  const std::string digest = md5(bytes);
  S3Request request{"PUT", key, {}, metadata_of(block_sums(bytes)), bytes};
  request.headers.emplace_back("content-md5", encode_base64(digest));
  forget(key);
  const Result<S3Answer> answer = client_.send(request);
  forget(key);
  if (!answer.ok()) return answer.error();
  if (answer->status != 200) return client_.explain(*answer, "storing " + key);
  if (is_other_md5(*answer, digest::hex(digest)))
    return wrong_bytes(key, "the server says that it has stored other bytes than it was sent");
  return StoredBlob{bytes.size(), version_of(header(*answer, "etag"))};
}

Result<S3Blobs::Object> S3Blobs::ask_for(const std::string& key) {
  const Result<S3Answer> answer = client_.send({"HEAD", key});
  if (!answer.ok()) return answer.error();
  if (answer->status == 404) return not_there(key);
  if (answer->status != 200) return client_.explain(*answer, "asking for " + key);
  const std::string etag = header(*answer, "etag");
  if (etag.empty()) return wrong_bytes(key, "the server gives no entity tag");
  const Result<BlockSums> sums = parse_metadata(answer->headers, answer->announced_bytes);
  if (!sums.ok()) return in_context(key + " in S3", sums.error());
  return Object{etag, *sums};
}

Result<S3Blobs::Object> S3Blobs::object_of(const std::string& key) {
  std::uint64_t change_count = 0;
  {
    const std::lock_guard lock(mutex_);
    if (const auto known = objects_.find(key); known != objects_.end()) return known->second;
    change_count = change_count_;
  }
  Result<Object> object = ask_for(key);
  const std::lock_guard lock(mutex_);
  if (object.ok() && change_count == change_count_) {
    if (objects_.size() >= kMaxObjectsKnown) objects_.clear();
    objects_[key] = *object;
  }
  return object;
}

const std::string* S3Blobs::find_block(const std::string& key, const std::string& etag,
                                       std::size_t number) {
  const auto found = std::find_if(blocks_.begin(), blocks_.end(), [&](const Block& block) {
    return block.number == number && block.etag == etag && block.key == key;
  });
  if (found == blocks_.end()) return nullptr;
  blocks_.splice(blocks_.begin(), blocks_, found);
  return &found->bytes;
}

void S3Blobs::keep_blocks(const std::string& key, const Object& object, const Span& span,
                          const std::string& bytes) {
  if (span.end_block - span.first_block > kMaxSpanKept) return;
  const std::lock_guard lock(mutex_);
  const auto known = objects_.find(key);
  if (known == objects_.end() || known->second.etag != object.etag) return;  // it is being replaced
  for (std::size_t i = span.first_block; i < span.end_block; ++i)
    if (!find_block(key, object.etag, i))
      blocks_.push_front({key, object.etag, i,
                          bytes.substr((i - span.first_block) * object.sums.block_bytes,
                                       object.sums.block_bytes)});
  std::size_t kept_bytes = 0;
  for (auto block = blocks_.begin(); block != blocks_.end();) {
    kept_bytes += block->bytes.size();
    block = kept_bytes > kMaxBlocksKept_bytes ? blocks_.erase(block) : std::next(block);
  }
}

// Returns whole blocks. kNotFound: it has changed meanwhile. kCorruptData: these are not the bytes
// that were stored.
Result<std::string> S3Blobs::read_blocks(const std::string& key, const Object& object,
                                         const Span& span) {
  const std::uint64_t from = span.first_block * object.sums.block_bytes;
  const std::uint64_t end =
      std::min(object.sums.size_bytes, span.end_block * object.sums.block_bytes);
  S3Request request{"GET", key};
  request.headers = {{"if-match", object.etag},
                     {"range", fmt::format("bytes={}-{}", from, end - 1)}};
  request.max_answer_bytes = static_cast<std::size_t>(end - from);
  Result<S3Answer> answer = client_.send(request);
  if (!answer.ok()) return answer.error();
  // Some leave out that it is a part.
  const bool whole = answer->status == 200 && end - from == object.sums.size_bytes;
  if (answer->status == 412 || is_missing(*answer)) return not_there(key);
  if (answer->status != 206 && !whole) return client_.explain(*answer, "reading " + key);
  if (header(*answer, "etag") != object.etag) return not_there(key);
  if (answer->body.size() != end - from)
    return Error{ErrorCode::kCorruptData, fmt::format("the server has sent {} bytes of {}",
                                                      answer->body.size(), end - from)};
  for (std::size_t i = span.first_block; i < span.end_block; ++i) {
    const std::string_view block =
        std::string_view(answer->body)
            .substr((i - span.first_block) * object.sums.block_bytes, object.sums.block_bytes);
    if (!is_block(object.sums, i, block))
      return Error{ErrorCode::kCorruptData,
                   fmt::format("the server has sent other bytes than were stored, from byte {} on: "
                               "their checksum differs",
                               i * object.sums.block_bytes)};
  }
  return std::move(answer->body);
}

Result<std::string> S3Blobs::read_key(const std::string& key, std::uint64_t offset,
                                      std::size_t max_bytes) {
  Result<std::string> bytes = std::string();
  for (int i = 0; i < kReadAttempts; ++i) {
    const Result<Object> object = object_of(key);
    if (!object.ok()) return object.error();
    const std::uint64_t size = object->sums.size_bytes, block = object->sums.block_bytes;
    if (offset >= size || max_bytes == 0) return std::string();
    Span span{offset, offset + std::min<std::uint64_t>(max_bytes, size - offset), 0, 0};
    span.first_block = static_cast<std::size_t>(span.offset / block);
    span.end_block = static_cast<std::size_t>((span.end - 1) / block + 1);
    if (span.end_block - span.first_block == 1) {
      const std::lock_guard lock(mutex_);
      if (const std::string* kept = find_block(key, object->etag, span.first_block))
        return kept->substr(span.offset - span.first_block * block, span.end - span.offset);
    }
    bytes = read_blocks(key, *object, span);
    if (bytes.ok()) {
      keep_blocks(key, *object, span, *bytes);
      bytes->resize(static_cast<std::size_t>(span.end - span.first_block * block));
      bytes->erase(0, static_cast<std::size_t>(span.offset - span.first_block * block));
      return bytes;
    }
    if (bytes.error().code != ErrorCode::kNotFound && bytes.error().code != ErrorCode::kCorruptData)
      return bytes;
    forget(key);
  }
  if (bytes.error().code == ErrorCode::kNotFound)
    return wrong_bytes(key, "it changes while it is read");
  return wrong_bytes(key, bytes.error().message);
}

Status S3Blobs::remove_key(const std::string& key) {
  forget(key);
  const Result<S3Answer> answer = client_.send({"DELETE", key});
  forget(key);
  if (!answer.ok()) return answer.error();
  if (answer->status == 204 || answer->status == 200 || is_missing(*answer)) return Done{};
  return client_.explain(*answer, "removing " + key);
}

Result<StoredBlob> S3Blobs::put_blob(const std::string& scan_id, const std::string& name,
                                     const std::string& bytes) {
  return put_key(key_of(scan_id, name), bytes);
}

Status S3Blobs::put(const std::string& scan_id, const std::string& name, const std::string& bytes) {
  const Result<StoredBlob> stored = put_blob(scan_id, name, bytes);
  return stored.ok() ? Status(Done{}) : Status(stored.error());
}

Result<std::string> S3Blobs::read(const std::string& scan_id, const std::string& name,
                                  std::uint64_t offset, std::size_t max_bytes) {
  return read_key(key_of(scan_id, name), offset, max_bytes);
}

Result<StoredBlob> S3Blobs::find(const std::string& scan_id, const std::string& name) {
  const Result<Object> object = ask_for(key_of(scan_id, name));
  if (!object.ok()) return object.error();
  return StoredBlob{object->sums.size_bytes, version_of(object->etag)};
}

Result<std::uint64_t> S3Blobs::size_bytes(const std::string& scan_id, const std::string& name) {
  const Result<StoredBlob> blob = find(scan_id, name);
  return blob.ok() ? Result<std::uint64_t>(blob->size_bytes) : blob.error();
}

Result<std::string> S3Blobs::version(const std::string& scan_id, const std::string& name) {
  const Result<StoredBlob> blob = find(scan_id, name);
  return blob.ok() ? Result<std::string>(blob->version) : blob.error();
}

Status S3Blobs::list_keys(
    const std::string& under,
    const std::function<void(const std::string& key, const S3Object& object)>& each) {
  const std::string& prefix = client_.options().prefix;
  std::string token;
  for (int i = 0; i < kMaxPages; ++i) {
    S3Request request{"GET", ""};
    if (!token.empty()) request.query.emplace_back("continuation-token", token);
    request.query.emplace_back("list-type", "2");
    request.query.emplace_back("max-keys", std::to_string(client_.options().keys_in_page));
    request.query.emplace_back("prefix", prefix + under);
    request.max_answer_bytes = kMaxPage_bytes;
    const Result<S3Answer> answer = client_.send(request);
    if (!answer.ok()) return answer.error();
    if (answer->status != 200)
      return client_.explain(*answer, fmt::format("listing what is below '{}{}'", prefix, under));
    const Result<S3Page> page = parse_s3_page(answer->body);
    if (!page.ok()) return page.error();
    for (const S3Object& object : page->objects)
      if (object.key.rfind(prefix, 0) == 0) each(object.key.substr(prefix.size()), object);
    if (page->next.empty()) return Done{};
    if (page->next == token) break;
    token = page->next;
  }
  return Error{ErrorCode::kIo, "S3's list of objects has no end"};
}

Status S3Blobs::list_all(
    const std::function<void(const std::string& scan_id, const std::string& name,
                             const StoredBlob& blob)>& each) {
  return list_keys("", [&each](const std::string& key, const S3Object& object) {
    const std::size_t slash = std::min(key.find('/'), key.size());
    const std::string scan_id = key.substr(0, slash),
                      name = key.substr(std::min(slash + 1, key.size()));
    if (is_scan_id(scan_id) && is_blob_name(name))
      each(scan_id, name, {object.size_bytes, version_of(object.etag)});
  });
}

Result<std::vector<BlobInfo>> S3Blobs::list(const std::string& scan_id) {
  CHECK(is_scan_id(scan_id), "a list of something that is no scan id");
  std::vector<BlobInfo> found;
  const Status listed =
      list_keys(scan_id + "/", [&](const std::string& key, const S3Object& object) {
        const std::string name = key.substr(std::min(scan_id.size() + 1, key.size()));
        if (is_blob_name(name)) found.push_back({name, object.size_bytes});
      });
  if (!listed.ok()) return listed.error();
  std::sort(found.begin(), found.end(),
            [](const BlobInfo& a, const BlobInfo& b) { return a.name < b.name; });
  return found;
}

Status S3Blobs::remove(const std::string& scan_id) {
  const Result<std::vector<BlobInfo>> blobs = list(scan_id);
  if (!blobs.ok()) return blobs.error();
  for (const BlobInfo& blob : *blobs)
    if (Status status = remove(scan_id, blob.name); !status.ok()) return status;
  return Done{};
}

Status S3Blobs::remove(const std::string& scan_id, const std::string& name) {
  return remove_key(key_of(scan_id, name));
}

Status S3Blobs::ask() {
  const Result<S3Answer> answer = client_.send(
      {"GET", "", {{"list-type", "2"}, {"max-keys", "1"}, {"prefix", client_.options().prefix}}});
  if (!answer.ok()) return answer.error();
  return answer->status == 200 ? Status(Done{})
                               : Status(client_.explain(*answer, "listing objects"));
}

Status S3Blobs::check_access() {
  const std::string bytes =
      "Hermite checks at a start that it may store, read, list and remove here: " + random_hex(16);
  if (const Result<StoredBlob> stored = put_key(kCheckKey, bytes); !stored.ok())
    return stored.error();
  const Result<std::string> back = read_key(kCheckKey, 0, bytes.size());
  if (!back.ok()) return back.error();
  if (*back != bytes)
    return wrong_bytes(
        kCheckKey, "other bytes came back than were stored: does another server use this prefix?");
  bool listed = false;
  if (Status status =
          list_keys(kCheckKey, [&listed](const std::string&, const S3Object&) { listed = true; });
      !status.ok())
    return status;
  if (!listed) return wrong_bytes(kCheckKey, "it was stored and is not listed");
  return remove_key(kCheckKey);
}

Result<std::string> S3Blobs::owner() { return read_key(kOwnerKey, 0, 1024); }

Status S3Blobs::set_owner(const std::string& owner) {
  const Result<StoredBlob> stored = put_key(kOwnerKey, owner);
  return stored.ok() ? Status(Done{}) : Status(stored.error());
}

Status S3Blobs::remove_owner() { return remove_key(kOwnerKey); }

}  // namespace hermite::server
