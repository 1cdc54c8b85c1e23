// SPDX-FileCopyrightText: 2026 The bpa authors
// SPDX-License-Identifier: Apache-2.0
#pragma once

#include <array>
#include <string>

#include "core/base/log.hpp"
#include "core/base/status.hpp"
#include "idl/wire/participant.hpp"

// What a participant has in a keystore of SROS 2: KEYSTORE/enclaves/NAME.

namespace bpa::wire::detail {

struct Enclave {
  std::string name = "/";  ///< As peers see it; "/" without security.
  std::string folder;      ///< Absolute; empty: without security.

  bool secure() const { return !folder.empty(); }
};

/// The enclave that the options name, or else ROS_SECURITY_ENABLE, _KEYSTORE, _STRATEGY and
/// _ENCLAVE_OVERRIDE, as rcl reads them: where the strategy is not Enforce, what is missing costs a
/// warning and there is no security. `invalid_argument` for a bad name or variable, `not_found` for
/// a missing file, `unsupported` where Fast DDS's security does not keep its promise.
Result<Enclave> find_enclave(const SecurityOptions& options, const LogHook& log);

/// A file of an enclave, and the property by which DDS Security names it.
struct EnclaveFile {
  const char* name;
  const char* property;
};
inline constexpr std::array<EnclaveFile, 6> kEnclaveFiles = {{
    {"identity_ca.cert.pem", "dds.sec.auth.builtin.PKI-DH.identity_ca"},
    {"cert.pem", "dds.sec.auth.builtin.PKI-DH.identity_certificate"},
    {"key.pem", "dds.sec.auth.builtin.PKI-DH.private_key"},
    {"permissions_ca.cert.pem", "dds.sec.access.builtin.Access-Permissions.permissions_ca"},
    {"governance.p7s", "dds.sec.access.builtin.Access-Permissions.governance"},
    {"permissions.p7s", "dds.sec.access.builtin.Access-Permissions.permissions"},
}};
/// Certificates that are revoked; SROS 2 takes it where it is there.
inline constexpr EnclaveFile kRevokedFile = {"crl.pem", "dds.sec.auth.builtin.PKI-DH.identity_crl"};

}  // namespace bpa::wire::detail
