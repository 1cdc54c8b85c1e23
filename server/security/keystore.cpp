// SPDX-FileCopyrightText: 2026 The bpa authors
// SPDX-License-Identifier: Apache-2.0
#include "server/security/keystore.hpp"

#include <cerrno>
#include <cstdlib>
#include <cstring>
#include <ctime>
#include <exception>
#include <filesystem>

#include <fcntl.h>
#include <sys/stat.h>
#include <unistd.h>

#include "core/base/concat.hpp"
#include "core/base/failure.hpp"
#include "core/io/file_bytes.hpp"
#include "server/security/certificates.hpp"

namespace bpa::server {
namespace {

namespace fs = std::filesystem;

constexpr std::time_t kDay = 86400;
constexpr const char* kAuthority = "bpaCA";

/// From yesterday, for machines whose clocks are behind, for ten years.
Validity validity_from_now() {
  const std::time_t now = std::time(nullptr);
  return {now - kDay, now + 3650 * kDay};
}

std::string xml_time(std::time_t time) {
  std::tm utc = {};
  gmtime_r(&time, &utc);
  char text[32];
  std::strftime(text, sizeof text, "%Y-%m-%dT%H:%M:%S", &utc);
  return text;
}

std::string document(const char* schema, const std::string& body) {
  return concat(
      "<?xml version=\"1.0\" encoding=\"UTF-8\"?>\n",
      "<dds xmlns:xsi=\"http://www.w3.org/2001/XMLSchema-instance\"\n",
      "     xsi:noNamespaceSchemaLocation=\"http://www.omg.org/spec/DDS-SECURITY/20170901/", schema,
      "\">\n", body, "</dds>\n");
}

/// Only whom the authority knows takes part, messages are encrypted, packets are signed. As SROS 2
/// has it, which encrypts the data once more inside of its message: that keeps nobody else out, and
/// costs a frame of 1.5 MB a quarter of its time (tests/system/security/secure_latency.cpp).
constexpr const char* kGovernance =
    R"(      <allow_unauthenticated_participants>false</allow_unauthenticated_participants>
      <enable_join_access_control>true</enable_join_access_control>
      <discovery_protection_kind>ENCRYPT</discovery_protection_kind>
      <liveliness_protection_kind>ENCRYPT</liveliness_protection_kind>
      <rtps_protection_kind>SIGN</rtps_protection_kind>
      <topic_access_rules>
        <topic_rule>
          <topic_expression>*</topic_expression>
          <enable_discovery_protection>true</enable_discovery_protection>
          <enable_liveliness_protection>true</enable_liveliness_protection>
          <enable_read_access_control>true</enable_read_access_control>
          <enable_write_access_control>true</enable_write_access_control>
          <metadata_protection_kind>ENCRYPT</metadata_protection_kind>
          <data_protection_kind>NONE</data_protection_kind>
        </topic_rule>
      </topic_access_rules>
)";

std::string domain_xml(int domain) { return concat("<domains><id>", domain, "</id></domains>\n"); }

std::string governance_xml(int domain) {
  return document("omg_shared_ca_governance.xsd",
                  concat("  <domain_access_rules>\n    <domain_rule>\n      ", domain_xml(domain),
                         kGovernance, "    </domain_rule>\n  </domain_access_rules>\n"));
}

std::string topics_xml(const char* element, const std::vector<std::string>& topics) {
  std::string xml = concat("        <", element, ">\n          <topics>\n");
  for (const std::string& topic : topics) xml += "            <topic>" + topic + "</topic>\n";
  return concat(xml, "          </topics>\n        </", element, ">\n");
}

std::string permissions_xml(const Permissions& permissions, int domain, const Validity& validity) {
  return document(
      "omg_shared_ca_permissions.xsd",
      concat(
          "  <permissions>\n    <grant name=\"", permissions.enclave,
          "\">\n      <subject_name>CN=", permissions.enclave,
          "</subject_name>\n      <validity>\n        <not_before>", xml_time(validity.from),
          "</not_before>\n        <not_after>", xml_time(validity.until),
          "</not_after>\n      </validity>\n      <allow_rule>\n        ", domain_xml(domain),
          topics_xml("publish", permissions.publish),
          topics_xml("subscribe", permissions.subscribe),
          "      </allow_rule>\n      <default>DENY</default>\n    </grant>\n  </permissions>\n"));
}

void put(const fs::path& path, const std::string& text) {
  or_throw(io::write_file(path.string(), text));
}

/// Only its owner may ever read it.
void put_key(const fs::path& path, const std::string& pem) {
  const int file = open(path.c_str(), O_WRONLY | O_CREAT | O_EXCL | O_CLOEXEC, S_IRUSR | S_IWUSR);
  const bool written = file >= 0 &&
                       write(file, pem.data(), pem.size()) == static_cast<ssize_t>(pem.size()) &&
                       fsync(file) == 0;
  const int error = errno;
  if (file >= 0) close(file);
  if (!written) {
    throw Failure(unavailable("cannot write ", path.string(), ": ", std::strerror(error)));
  }
}

void write_enclave(const fs::path& place, const Permissions& permissions, int domain,
                   const Identity& authority, const Validity& validity,
                   const std::string& signed_governance) {
  const Identity identity = authority.issue(permissions.enclave, validity);
  const std::string xml = permissions_xml(permissions, domain, validity);
  // Whole files rather than SROS 2's links: an enclave is copied to another machine by itself.
  put(place / "identity_ca.cert.pem", authority.certificate_pem());
  put(place / "permissions_ca.cert.pem", authority.certificate_pem());
  put(place / "cert.pem", identity.certificate_pem());
  put_key(place / "key.pem", identity.key_pem());
  put(place / "governance.p7s", signed_governance);
  put(place / "permissions.xml", xml);
  put(place / "permissions.p7s", authority.sign(xml));
}

void write_all(const fs::path& folder, const std::vector<Permissions>& enclaves, int domain) {
  const Validity validity = validity_from_now();
  const Identity authority = Identity::authority(kAuthority, validity);
  const std::string governance = governance_xml(domain);
  const std::string signed_governance = authority.sign(governance);
  fs::create_directory(folder / "private");
  fs::permissions(folder / "private", fs::perms::owner_all);
  put(folder / "public/ca.cert.pem", authority.certificate_pem());
  put_key(folder / "private/ca.key.pem", authority.key_pem());
  for (const char* role : {"identity_ca", "permissions_ca"}) {
    fs::create_symlink("ca.cert.pem", folder / "public" / concat(role, ".cert.pem"));
    fs::create_symlink("ca.key.pem", folder / "private" / concat(role, ".key.pem"));
  }
  put(folder / "enclaves/governance.xml", governance);
  put(folder / "enclaves/governance.p7s", signed_governance);
  for (const Permissions& enclave : enclaves) {
    write_enclave(folder / ("enclaves" + enclave.enclave), enclave, domain, authority, validity,
                  signed_governance);
  }
}

}  // namespace

void make_keystore(const std::string& folder, const std::vector<Permissions>& enclaves,
                   int domain) {
  const auto refuse = [&](const std::string& reason) {
    throw Failure(unavailable("cannot make the keystore ", folder, ": ", reason));
  };
  std::string path = folder;
  while (path.size() > 1 && path.back() == '/') path.pop_back();
  std::error_code error;
  if (fs::exists(fs::symlink_status(path, error))) refuse("it is there already");
  // Beside, then renamed: a keystore is whole, or not there.
  std::string fresh = path + ".XXXXXX";
  if (mkdtemp(fresh.data()) == nullptr) refuse(std::strerror(errno));
  try {
    write_all(fresh, enclaves, domain);
    fs::rename(fresh, path);
  } catch (const std::exception& failure) {
    fs::remove_all(fresh, error);
    refuse(failure.what());
  }
}

}  // namespace bpa::server
