// A self-signed certificate for a name or address, and its key, as PEM files. Header only.
#pragma once

#include <openssl/evp.h>
#include <openssl/pem.h>
#include <openssl/x509v3.h>

#include <cstdio>
#include <memory>
#include <stdexcept>
#include <string>

namespace hermite::test {

struct CertificateFiles {
  std::string certificate, key;
};

// `subject`: "DNS:scanner.example" or "IP:127.0.0.1". Valid for a day from now, or, `expired`,
// until yesterday.
inline CertificateFiles make_certificate(const std::string& folder, const std::string& name,
                                         const std::string& subject, bool expired = false) {
  const std::unique_ptr<EVP_PKEY, decltype(&EVP_PKEY_free)> key(EVP_EC_gen("P-256"), EVP_PKEY_free);
  const std::unique_ptr<X509, decltype(&X509_free)> certificate(X509_new(), X509_free);
  X509* const x = certificate.get();
  constexpr long kDay_s = 86'400;
  X509_set_version(x, 2);
  ASN1_INTEGER_set(X509_get_serialNumber(x), 1);
  X509_gmtime_adj(X509_getm_notBefore(x), -2 * kDay_s);
  X509_gmtime_adj(X509_getm_notAfter(x), expired ? -kDay_s : kDay_s);
  X509_set_pubkey(x, key.get());
  X509_NAME_add_entry_by_txt(X509_get_subject_name(x), "CN", MBSTRING_ASC,
                             reinterpret_cast<const unsigned char*>(name.c_str()), -1, -1, 0);
  X509_set_issuer_name(x, X509_get_subject_name(x));
  const std::unique_ptr<X509_EXTENSION, decltype(&X509_EXTENSION_free)> names(
      X509V3_EXT_conf_nid(nullptr, nullptr, NID_subject_alt_name, subject.c_str()),
      X509_EXTENSION_free);
  X509_add_ext(x, names.get(), -1);
  X509_sign(x, key.get(), EVP_sha256());
  const CertificateFiles files{folder + "/" + name + ".pem", folder + "/" + name + ".key"};
  std::FILE* const out = std::fopen(files.certificate.c_str(), "w");
  std::FILE* const key_out = std::fopen(files.key.c_str(), "w");
  if (!out || !key_out) throw std::runtime_error("writing " + files.certificate);
  PEM_write_X509(out, x);
  PEM_write_PrivateKey(key_out, key.get(), nullptr, nullptr, 0, nullptr, nullptr);
  std::fclose(out);
  std::fclose(key_out);
  return files;
}

}  // namespace hermite::test
