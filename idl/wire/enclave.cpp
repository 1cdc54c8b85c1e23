// SPDX-FileCopyrightText: 2026 The bpa authors
// SPDX-License-Identifier: Apache-2.0
#include "idl/wire/private/enclave.hpp"

#include <filesystem>

#include <unistd.h>

#include "core/base/concat.hpp"
#include "idl/wire/private/environment.hpp"

namespace bpa::wire::detail {
namespace {

constexpr bool kHasSecurity = BPA_DDS_SECURITY;
constexpr const char* kWhyNot =
    " has no security that keeps strangers from cutting peers off (2.9: CVE-2023-50257). Use "
    "Debian "
    "13, or set no keystore and keep strangers away by the network's interfaces, a firewall or a "
    "list of peers: docs/security.md";

struct Asked {
  SecurityOptions options;
  bool enforce = true;
};

/// What the environment asks for; an empty keystore: nothing. A typing error must not switch
/// security off, so words that rcl would pass over are refused.
Result<Asked> asked_by_environment(const SecurityOptions& options) {
  const std::string enable = variable("ROS_SECURITY_ENABLE");
  if (enable.empty() || enable == "false") return Asked{};
  if (enable != "true") {
    return invalid_argument("ROS_SECURITY_ENABLE is '", enable, "'; it must be true or false");
  }
  const std::string strategy = variable("ROS_SECURITY_STRATEGY");
  if (!strategy.empty() && strategy != "Enforce" && strategy != "Permissive") {
    return invalid_argument("ROS_SECURITY_STRATEGY is '", strategy,
                            "'; it must be Enforce or Permissive");
  }
  Asked asked{options, strategy == "Enforce"};
  asked.options.keystore = variable("ROS_SECURITY_KEYSTORE");
  if (asked.options.keystore.empty()) {
    return invalid_argument("ROS_SECURITY_ENABLE is true and ROS_SECURITY_KEYSTORE is not set");
  }
  const std::string other = variable("ROS_SECURITY_ENCLAVE_OVERRIDE");
  if (!other.empty()) asked.options.enclave = other;
  return asked;
}

Result<Enclave> open_enclave(const SecurityOptions& options) {
  if (!kHasSecurity) {
    return Status(StatusCode::unsupported,
                  concat("keystore ", options.keystore, " is refused: Fast DDS ",
                         BPA_FASTDDS_VERSION, kWhyNot));
  }
  if (Status status = validate_full_name(options.enclave); !status.ok() && options.enclave != "/") {
    return invalid_argument("enclave '", options.enclave, "': ", status.message);
  }
  std::error_code error;
  const auto keystore = std::filesystem::absolute(options.keystore, error);
  const Enclave enclave{options.enclave, (keystore / "enclaves").string() +
                                             (options.enclave == "/" ? "" : options.enclave)};
  for (const EnclaveFile& file : kEnclaveFiles) {
    const std::string path = concat(enclave.folder, "/", file.name);
    if (access(path.c_str(), R_OK) == 0) continue;
    return not_found("enclave ", options.enclave, ": ", path,
                     " is not there or may not be read; bpa-server --make-keystore or ros2 "
                     "security create_enclave make it");
  }
  return enclave;
}

}  // namespace

Result<Enclave> find_enclave(const SecurityOptions& options, const LogHook& log) {
  if (!options.keystore.empty()) return open_enclave(options);
  const Result<Asked> asked = asked_by_environment(options);
  if (!asked.ok()) return asked.status();
  if (asked->options.keystore.empty()) return Enclave{};
  Result<Enclave> enclave = open_enclave(asked->options);
  if (enclave.ok() || asked->enforce) return enclave;
  bpa::log(log, LogLevel::warning,
           "no security, since ROS_SECURITY_STRATEGY is not Enforce: " + enclave.status().message);
  return Enclave{};
}

}  // namespace bpa::wire::detail
