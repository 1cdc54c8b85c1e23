// SPDX-FileCopyrightText: 2026 The bpa authors
// SPDX-License-Identifier: Apache-2.0
#include "server/security/certificates.hpp"

#include <cstdint>

#include <openssl/err.h>
#include <openssl/evp.h>
#include <openssl/pem.h>
#include <openssl/pkcs7.h>
#include <openssl/rand.h>
#include <openssl/x509v3.h>

#include "core/base/concat.hpp"
#include "core/base/failure.hpp"

namespace bpa::server {
namespace {

void check(bool done, const char* what) {
  if (done) return;
  char reason[256] = "no reason given";
  if (const unsigned long code = ERR_get_error(); code != 0) {
    ERR_error_string_n(code, reason, sizeof reason);
  }
  throw Failure(Status(StatusCode::internal, concat("OpenSSL cannot ", what, ": ", reason)));
}

template <auto kFree>
struct Free {
  template <class T>
  void operator()(T* object) const {
    kFree(object);
  }
};
using Bio = std::unique_ptr<BIO, Free<BIO_free_all>>;
using Signature = std::unique_ptr<PKCS7, Free<PKCS7_free>>;
using Extension = std::unique_ptr<X509_EXTENSION, Free<X509_EXTENSION_free>>;

/// What `write` puts into memory.
template <class Write>
std::string written(const char* what, const Write& write) {
  const Bio memory(BIO_new(BIO_s_mem()));
  check(memory != nullptr && write(memory.get()) == 1, what);
  char* bytes = nullptr;
  const long size = BIO_get_mem_data(memory.get(), &bytes);
  return {bytes, static_cast<std::size_t>(size)};
}

bool set_serial(X509* certificate) {
  std::uint64_t serial = 0;
  return RAND_bytes(reinterpret_cast<unsigned char*>(&serial), sizeof serial) == 1 &&
         ASN1_INTEGER_set_uint64(X509_get_serialNumber(certificate), serial >> 1U) == 1;
}

bool set_names(X509* certificate, const std::string& common_name, const X509* issuer) {
  X509_NAME* subject = X509_get_subject_name(certificate);
  const auto* name = reinterpret_cast<const unsigned char*>(common_name.c_str());
  return X509_NAME_add_entry_by_NID(subject, NID_commonName, MBSTRING_UTF8, name, -1, -1, 0) == 1 &&
         X509_set_issuer_name(certificate,
                              issuer == nullptr ? subject : X509_get_subject_name(issuer)) == 1;
}

bool set_validity(X509* certificate, const Validity& validity) {
  return ASN1_TIME_set(X509_getm_notBefore(certificate), validity.from) != nullptr &&
         ASN1_TIME_set(X509_getm_notAfter(certificate), validity.until) != nullptr;
}

bool set_role(X509* certificate, bool is_authority) {
  const Extension role(
      X509V3_EXT_conf_nid(nullptr, nullptr, NID_basic_constraints,
                          is_authority ? "critical,CA:TRUE,pathlen:1" : "CA:FALSE"));
  return role != nullptr && X509_add_ext(certificate, role.get(), -1) == 1;
}

}  // namespace

struct Identity::Parts {
  std::shared_ptr<EVP_PKEY> key{EVP_EC_gen("P-256"), EVP_PKEY_free};
  std::shared_ptr<X509> certificate{X509_new(), X509_free};
};

Identity Identity::make(const std::string& common_name, const Validity& validity,
                        const Parts* issuer) {
  const auto parts = std::make_shared<Parts>();
  check(parts->key != nullptr && parts->certificate != nullptr, "make a key");
  X509* certificate = parts->certificate.get();
  EVP_PKEY* signer = issuer == nullptr ? parts->key.get() : issuer->key.get();
  check(X509_set_version(certificate, X509_VERSION_3) == 1 && set_serial(certificate) &&
            set_names(certificate, common_name,
                      issuer == nullptr ? nullptr : issuer->certificate.get()) &&
            set_validity(certificate, validity) && set_role(certificate, issuer == nullptr) &&
            X509_set_pubkey(certificate, parts->key.get()) == 1 &&
            X509_sign(certificate, signer, EVP_sha256()) > 0,
        "make a certificate");
  return Identity(parts);
}

Identity Identity::authority(const std::string& common_name, const Validity& validity) {
  return make(common_name, validity, nullptr);
}

Identity Identity::issue(const std::string& common_name, const Validity& validity) const {
  return make(common_name, validity, parts_.get());
}

std::string Identity::certificate_pem() const {
  return written("write a certificate",
                 [&](BIO* to) { return PEM_write_bio_X509(to, parts_->certificate.get()); });
}

std::string Identity::key_pem() const {
  return written("write a key", [&](BIO* to) {
    return PEM_write_bio_PKCS8PrivateKey(to, parts_->key.get(), nullptr, nullptr, 0, nullptr,
                                         nullptr);
  });
}

std::string Identity::sign(const std::string& text) const {
  constexpr int kFlags = PKCS7_TEXT | PKCS7_DETACHED | PKCS7_STREAM;
  const Bio content(BIO_new_mem_buf(text.data(), static_cast<int>(text.size())));
  check(content != nullptr, "take memory");
  const Signature signature(
      PKCS7_sign(parts_->certificate.get(), parts_->key.get(), nullptr, content.get(), kFlags));
  check(signature != nullptr, "sign");
  return written("sign", [&](BIO* to) {
    return SMIME_write_PKCS7(to, signature.get(), content.get(), kFlags);
  });
}

}  // namespace bpa::server
