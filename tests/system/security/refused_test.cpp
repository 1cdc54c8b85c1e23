// SPDX-FileCopyrightText: 2026 The bpa authors
// SPDX-License-Identifier: Apache-2.0
#include <gtest/gtest.h>

#include "tests/support/stub_server.hpp"

// A Fast DDS whose security does not keep strangers out: who asks for it is told what to do
// instead.

namespace bpa {
namespace {

void expect_advice(const std::string& text) {
  for (const char* words : {"keystore /etc/keys is refused", "CVE-2023-50257", "Debian 13",
                            "interfaces", "firewall", "list of peers", "docs/security.md"}) {
    EXPECT_NE(text.find(words), std::string::npos) << words << " in: " << text;
  }
}

TEST(RefusedKeystore, ServerDoesNotStart) {
  support::StubServer server({"security.keystore=/etc/keys"});
  EXPECT_EQ(server.process().wait(std::chrono::seconds(20)), 1);
  expect_advice(server.log());
}

TEST(RefusedKeystore, SdkDoesNotConnect) {
  ClientOptions options = support::client_options();
  options.keystore = "/etc/keys";
  const auto client = Client::connect(options);
  EXPECT_EQ(client.status().code, StatusCode::unsupported);
  expect_advice(client.status().message);
}

}  // namespace
}  // namespace bpa
