// Blobs as objects of S3: PREFIX + SCAN/NAME. Every function asks the server and may take as long
// as S3Patience says; for the network thread see remote_blobs.h.
//
// What is checked: of a put, that the server has received these bytes (their SHA-256 is signed, and
// their MD5 sent along) and what it says it has stored; of a read, the checksum of every block that
// is touched (block_sums.h), so nothing that was cut off, mixed up or altered is given out. An
// object that another program has put there has no checksums and is not read.
//
// A blob is put in one request and is held in memory, as by the interface; S3 takes up to 5 GiB at
// once. It becomes visible whole, or not at all.
#pragma once

#include <cstdint>
#include <functional>
#include <list>
#include <map>
#include <memory>
#include <mutex>
#include <string>
#include <vector>

#include "server/s3/block_sums.h"
#include "server/s3/s3_client.h"
#include "server/s3/s3_xml.h"
#include "server/store/blobs.h"

namespace hermite::server {

inline constexpr std::uint64_t kMaxS3Put_bytes = std::uint64_t{5} * 1024 * 1024 * 1024;

// What is stored under a name.
struct StoredBlob {
  std::uint64_t size_bytes = 0;
  std::string version;
  bool operator==(const StoredBlob&) const = default;
};

class S3Blobs : public Blobs {
 public:
  explicit S3Blobs(S3Options options) : client_(std::move(options)) {}

  Status put(const std::string& scan_id, const std::string& name,
             const std::string& bytes) override;
  // The same, with the version. kTooLarge: more than kMaxS3Put_bytes.
  Result<StoredBlob> put_blob(const std::string& scan_id, const std::string& name,
                              const std::string& bytes);
  Result<std::string> read(const std::string& scan_id, const std::string& name,
                           std::uint64_t offset, std::size_t max_bytes) override;
  Result<std::uint64_t> size_bytes(const std::string& scan_id, const std::string& name) override;
  // The same, with the version.
  Result<StoredBlob> find(const std::string& scan_id, const std::string& name);
  Result<std::string> version(const std::string& scan_id, const std::string& name) override;
  Result<std::vector<BlobInfo>> list(const std::string& scan_id) override;
  Status remove(const std::string& scan_id) override;
  Status remove(const std::string& scan_id, const std::string& name) override;
  Status availability() override;

  // Calls `each` for every blob of every scan, in no certain order. kIo, kCorruptData.
  Status list_all(const std::function<void(const std::string& scan_id, const std::string& name,
                                           const StoredBlob& blob)>& each);

  // Asks for something small. kIo: S3 does not answer, or not as it should.
  Status ask();

  // Puts an object, reads, lists and removes it. kIo: what does not work, with a message for the
  // operator.
  Status check_access();

  // The folder of data that owns this prefix: a text. kNotFound: none does yet. kIo.
  Result<std::string> owner();
  Status set_owner(const std::string& owner);
  Status remove_owner();

  void stop() { client_.stop(); }  // see S3Client
  std::string address() const;     // s3://BUCKET/PREFIX

 private:
  struct Object {
    std::string etag;  // with quotes
    BlockSums sums;
  };
  struct Block {
    std::string key, etag;
    std::size_t number = 0;
    std::string bytes;
  };
  struct Span {
    std::uint64_t offset = 0, end = 0;           // bytes that are wanted
    std::size_t first_block = 0, end_block = 0;  // that have them
  };
  Result<StoredBlob> put_key(const std::string& key, const std::string& bytes);
  Result<std::string> read_key(const std::string& key, std::uint64_t offset, std::size_t max_bytes);
  Status remove_key(const std::string& key);
  Result<Object> ask_for(const std::string& key);
  Result<Object> object_of(const std::string& key);
  Result<std::string> read_blocks(const std::string& key, const Object& object, const Span& span);
  Status list_keys(const std::string& under,
                   const std::function<void(const std::string& key, const S3Object& object)>& each);
  const std::string* find_block(const std::string& key, const std::string& etag,
                                std::size_t number);
  void keep_blocks(const std::string& key, const Object& object, const Span& span,
                   const std::string& bytes);
  void forget(const std::string& key);

  S3Client client_;
  std::mutex mutex_;                       // guards everything below
  std::uint64_t change_count_ = 0;         // of puts and removals that have begun or ended
  std::map<std::string, Object> objects_;  // by key: what was read last
  std::list<Block> blocks_;                // the newest first
};

}  // namespace hermite::server
