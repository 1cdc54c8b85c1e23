// SPDX-FileCopyrightText: 2026 The bpa authors
// SPDX-License-Identifier: Apache-2.0
#include "idl/wire/private/enclave.hpp"

#include <cstdlib>

#include <gtest/gtest.h>

#include "tests/idl/wire/domain.hpp"
#include "tests/support/temporary_folder.hpp"

namespace bpa::wire::detail {
namespace {

/// The environment says nothing of security, before and after.
class FindEnclave : public testing::Test {
 protected:
  FindEnclave() { clear(); }
  ~FindEnclave() override { clear(); }
  static void clear() {
    for (const char* name : {"ROS_SECURITY_ENABLE", "ROS_SECURITY_STRATEGY",
                             "ROS_SECURITY_KEYSTORE", "ROS_SECURITY_ENCLAVE_OVERRIDE"}) {
      unsetenv(name);
    }
  }
  /// ENABLE, STRATEGY and KEYSTORE; null: not set.
  static void set(const char* enable, const char* strategy, const std::string& keystore) {
    clear();
    if (enable != nullptr) setenv("ROS_SECURITY_ENABLE", enable, 1);
    if (strategy != nullptr) setenv("ROS_SECURITY_STRATEGY", strategy, 1);
    if (!keystore.empty()) setenv("ROS_SECURITY_KEYSTORE", keystore.c_str(), 1);
  }
  Result<Enclave> find(const SecurityOptions& options) {
    warnings_.clear();
    return find_enclave(options, [this](LogLevel, std::string_view text) { warnings_ += text; });
  }
  /// Has all files of an enclave; only their names count here.
  void make(const std::string& enclave) {
    for (const EnclaveFile& file : kEnclaveFiles) {
      test::spill(folder_ / ("enclaves" + enclave + "/" + file.name), "");
    }
  }
  std::string keystore() const { return folder_.path(); }
  const std::string& warnings() const { return warnings_; }

 private:
  const test::TemporaryFolder folder_;
  std::string warnings_;
};

bool has(const Status& status, const char* text) {
  return status.message.find(text) != std::string::npos;
}

TEST_F(FindEnclave, NoneUnlessAsked) {
  for (const char* enable : {static_cast<const char*>(nullptr), "", "false"}) {
    set(enable, "Enforce", keystore());
    const auto found = find({"", "/robot"});
    ASSERT_TRUE(found.ok()) << found.status().message;
    EXPECT_FALSE(found->secure());
    EXPECT_EQ(found->name, "/");
  }
}

TEST_F(FindEnclave, WordsThatWouldSwitchSecurityOffByMistakeAreRefused) {
  make("/robot");
  const struct {
    const char* enable;
    const char* strategy;
    bool keystore;
    const char* reason;
  } cases[] = {{"True", "Enforce", true, "ROS_SECURITY_ENABLE is 'True'"},
               {"true", "enforce", true, "ROS_SECURITY_STRATEGY is 'enforce'"},
               {"true", "Enforce", false, "ROS_SECURITY_KEYSTORE"}};
  for (const auto& c : cases) {
    set(c.enable, c.strategy, c.keystore ? keystore() : "");
    const auto found = find({"", "/robot"});
    EXPECT_EQ(found.status().code, StatusCode::invalid_argument) << c.reason;
    EXPECT_TRUE(has(found.status(), c.reason)) << found.status().message;
  }
}

#if BPA_DDS_SECURITY

TEST_F(FindEnclave, OfTheOptionsOrOfTheEnvironment) {
  make("/robot");
  make("/arm/left");
  make("");
  EXPECT_EQ(find({keystore(), "/robot"})->folder, keystore() + "/enclaves/robot");
  EXPECT_EQ(find({keystore(), "/"})->folder, keystore() + "/enclaves");
  set("true", "Enforce", keystore());
  EXPECT_EQ(find({"", "/arm/left"})->folder, keystore() + "/enclaves/arm/left");
  setenv("ROS_SECURITY_ENCLAVE_OVERRIDE", "/robot", 1);
  EXPECT_EQ(find({"", "/arm/left"})->name, "/robot");
  EXPECT_EQ(find({keystore(), "/arm/left"})->name, "/arm/left");  // what is set holds
}

TEST_F(FindEnclave, NamesTheFileThatIsMissing) {
  make("/robot");
  std::filesystem::remove(keystore() + "/enclaves/robot/permissions.p7s");
  const auto found = find({keystore(), "/robot"});
  EXPECT_EQ(found.status().code, StatusCode::not_found);
  EXPECT_TRUE(has(found.status(), "robot/permissions.p7s")) << found.status().message;
  for (const char* name : {"robot", "/../robot", "", "/a b"}) {
    EXPECT_EQ(find({keystore(), name}).status().code, StatusCode::invalid_argument) << name;
  }
}

TEST_F(FindEnclave, OnlyWhatIsNotEnforcedGoesOnWithout) {
  set("true", nullptr, keystore());
  const auto found = find({"", "/robot"});
  ASSERT_TRUE(found.ok()) << found.status().message;
  EXPECT_FALSE(found->secure());
  EXPECT_NE(warnings().find("no security"), std::string::npos) << warnings();
  set("true", "Enforce", keystore());
  EXPECT_EQ(find({"", "/robot"}).status().code, StatusCode::not_found);
  set("true", nullptr, keystore());
  EXPECT_EQ(find({keystore(), "/robot"}).status().code, StatusCode::not_found);
}

TEST_F(FindEnclave, ParticipantWithDamagedFilesDoesNotStart) {
  make("/robot");
  ParticipantOptions options;
  options.discovery = test_discovery();
  options.security = {keystore(), "/robot"};
  const auto participant = Participant::create(options);
  EXPECT_EQ(participant.status().code, StatusCode::unavailable);
  EXPECT_TRUE(has(participant.status(), "enclaves/robot is not in order"))
      << participant.status().message;
}

#else

TEST_F(FindEnclave, IsRefusedWithWhatToDoInstead) {
  make("/robot");
  const auto expect_refusal = [](const Status& status) {
    EXPECT_EQ(status.code, StatusCode::unsupported);
    for (const char* text :
         {"Debian 13", "CVE-2023-50257", "interfaces", "firewall", "peers", "docs/security.md"}) {
      EXPECT_TRUE(has(status, text)) << status.message;
    }
  };
  expect_refusal(find({keystore(), "/robot"}).status());
  set("true", "Enforce", keystore());
  expect_refusal(find({"", "/robot"}).status());
  ParticipantOptions options;
  options.discovery = test_discovery();
  options.security = {keystore(), "/robot"};
  expect_refusal(Participant::create(options).status());
}

TEST_F(FindEnclave, OnlyWhatIsNotEnforcedGoesOnWithout) {
  set("true", "Permissive", keystore());
  const auto found = find({"", "/robot"});
  ASSERT_TRUE(found.ok()) << found.status().message;
  EXPECT_FALSE(found->secure());
  EXPECT_NE(warnings().find("Debian 13"), std::string::npos) << warnings();
}

#endif

}  // namespace
}  // namespace bpa::wire::detail
