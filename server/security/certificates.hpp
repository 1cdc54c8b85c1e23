// SPDX-FileCopyrightText: 2026 The bpa authors
// SPDX-License-Identifier: Apache-2.0
#pragma once

#include <ctime>
#include <memory>
#include <string>

namespace bpa::server {

/// Seconds of UTC since 1970.
struct Validity {
  std::time_t from = 0;
  std::time_t until = 0;
};

/// A key and its certificate, of the kind that DDS Security asks for: EC prime256v1, SHA-256. What
/// OpenSSL refuses is thrown as a Failure.
class Identity {
 public:
  /// One that signs its own certificate and those of others.
  static Identity authority(const std::string& common_name, const Validity& validity);
  /// Another whose certificate this one signs.
  Identity issue(const std::string& common_name, const Validity& validity) const;

  std::string certificate_pem() const;
  std::string key_pem() const;
  /// The text as S/MIME: in the clear, with this authority's signature beside it.
  std::string sign(const std::string& text) const;

 private:
  struct Parts;
  static Identity make(const std::string& common_name, const Validity& validity,
                       const Parts* issuer);
  explicit Identity(std::shared_ptr<const Parts> parts) : parts_(std::move(parts)) {}
  std::shared_ptr<const Parts> parts_;
};

}  // namespace bpa::server
