// SPDX-FileCopyrightText: 2026 The bpa authors
// SPDX-License-Identifier: Apache-2.0
#include "server/security/keystore.hpp"

#include <algorithm>
#include <filesystem>

#include <gtest/gtest.h>

#include "core/base/failure.hpp"
#include "tests/support/process.hpp"
#include "tests/support/temporary_folder.hpp"

namespace bpa::server {
namespace {

namespace fs = std::filesystem;

/// Runs the openssl command, which is not the library's code that wrote the files; what it says.
std::string openssl(std::vector<std::string> words, const std::string& log_path) {
  words.insert(words.begin(), "/usr/bin/openssl");
  EXPECT_EQ(support::run(words, log_path), 0) << support::read_text(log_path);
  return support::read_text(log_path);
}

bool has(const std::string& text, const std::string& part) {
  return text.find(part) != std::string::npos;
}

class Keystore : public testing::Test {
 protected:
  Keystore() { make_keystore(path(), default_permissions(ServerOptions()), 42); }
  std::string path(const std::string& name = "") const {
    return folder_ / (name.empty() ? "keystore" : "keystore/" + name);
  }
  std::string log() const { return folder_ / "openssl.log"; }

 private:
  const test::TemporaryFolder folder_;
};

TEST_F(Keystore, HasTheFilesOfSros2) {
  for (const char* name : {"/bpa_server", "/robot", "/viewer"}) {
    for (const char* file :
         {"cert.pem", "key.pem", "identity_ca.cert.pem", "permissions_ca.cert.pem",
          "governance.p7s", "permissions.p7s", "permissions.xml"}) {
      EXPECT_TRUE(fs::is_regular_file(path("enclaves") + name + "/" + file)) << name << file;
    }
  }
  // Where SROS 2 looks when it adds an enclave.
  for (const char* file : {"public/identity_ca.cert.pem", "public/permissions_ca.cert.pem",
                           "private/identity_ca.key.pem", "private/permissions_ca.key.pem",
                           "enclaves/governance.p7s"}) {
    EXPECT_TRUE(fs::is_regular_file(path(file))) << file;
  }
}

TEST_F(Keystore, KeysAreForTheirOwnerAlone) {
  int keys = 0;
  for (const auto& entry : fs::recursive_directory_iterator(path())) {
    if (!entry.is_regular_file() || entry.is_symlink()) continue;
    if (!has(test::slurp(entry.path().string()), "PRIVATE KEY")) continue;
    ++keys;
    EXPECT_EQ(fs::status(entry).permissions(), fs::perms::owner_read | fs::perms::owner_write)
        << entry;
  }
  EXPECT_EQ(keys, 4);
  EXPECT_EQ(fs::status(path()).permissions(), fs::perms::owner_all);
}

TEST_F(Keystore, OpensslTrustsItsCertificatesAndSignatures) {
  const std::string authority = path("public/ca.cert.pem");
  const std::string robot = path("enclaves/robot/");
  EXPECT_TRUE(has(openssl({"verify", "-CAfile", authority, robot + "cert.pem"}, log()), "OK"));
  const std::string about = openssl({"x509", "-in", robot + "cert.pem", "-noout", "-text"}, log());
  EXPECT_TRUE(has(about, "CN = /robot") || has(about, "CN=/robot")) << about;
  EXPECT_TRUE(has(about, "prime256v1") && has(about, "ecdsa-with-SHA256")) << about;
  for (const char* file : {"governance", "permissions"}) {
    openssl({"smime", "-verify", "-CAfile", authority, "-in", robot + file + ".p7s", "-out",
             path("signed.xml")},
            log());
    EXPECT_TRUE(has(test::slurp(path("signed.xml")), "<id>42</id>"));
  }
}

TEST_F(Keystore, PermissionsAreThoseOfTheSettings) {
  ServerOptions options;
  options.node.ros_namespace = "/vision";
  options.node.remaps = {"/tf:=/robot/tf"};
  options.input.color = "cam";
  options.output.markers = "";
  const std::vector<Permissions> all = default_permissions(options);
  ASSERT_EQ(all.size(), 3U);
  const auto lists = [](const std::vector<std::string>& topics, const char* topic) {
    return std::count(topics.begin(), topics.end(), topic) == 1;
  };
  const Permissions& server = all[0];
  const Permissions& robot = all[1];
  const Permissions& viewer = all[2];
  EXPECT_TRUE(lists(server.publish, "rt/vision/interpretations"));
  EXPECT_TRUE(lists(server.publish, "rr/vision/*Reply"));
  EXPECT_TRUE(lists(server.subscribe, "rq/vision/*Request"));
  EXPECT_TRUE(lists(server.publish, "rt/robot/tf"));
  EXPECT_TRUE(lists(robot.publish, "rt/vision/cam/compressed"));
  EXPECT_TRUE(lists(robot.publish, "rq/vision/*Request"));
  EXPECT_TRUE(lists(robot.subscribe, "rr/vision/*Reply"));
  EXPECT_FALSE(lists(robot.publish, "rt/vision/interpretations"));
  EXPECT_FALSE(lists(robot.publish, "rr/vision/*Reply"));
  EXPECT_TRUE(lists(viewer.subscribe, "rt/vision/interpretations"));
  EXPECT_EQ(viewer.publish, std::vector<std::string>{"ros_discovery_info"});
  for (const std::string& topic : viewer.subscribe) EXPECT_NE(topic.rfind("rr", 0), 0U) << topic;
  for (const Permissions& one : all) EXPECT_FALSE(lists(one.subscribe, "rt/vision/markers"));
}

/// What make_keystore() says when it fails.
std::string refusal(const std::string& folder) {
  try {
    make_keystore(folder, default_permissions(ServerOptions()), 42);
    return "none";
  } catch (const Failure& failure) {
    return failure.status().message;
  }
}

TEST_F(Keystore, IsNeverWrittenOver) {
  const std::string before = test::slurp(path("private/ca.key.pem"));
  for (const std::string& same : {path(), path() + "/"}) {
    EXPECT_TRUE(has(refusal(same), "it is there already")) << refusal(same);
  }
  EXPECT_EQ(test::slurp(path("private/ca.key.pem")), before);
  EXPECT_EQ(std::distance(fs::directory_iterator(fs::path(path()).parent_path()), {}), 1);
}

TEST_F(Keystore, SaysWhyItCannotBeMade) {
  const std::string file = path("enclaves/governance.xml");
  EXPECT_TRUE(has(refusal(file + "/keystore"), "Not a directory")) << refusal(file + "/keystore");
  EXPECT_TRUE(has(refusal(path("nowhere/keystore")), "No such file or directory"));
  EXPECT_EQ(refusal(path("second/")), "none");
  EXPECT_TRUE(fs::is_regular_file(path("second/private/ca.key.pem")));
}

}  // namespace
}  // namespace bpa::server
