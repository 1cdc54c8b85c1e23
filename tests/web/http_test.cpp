// SPDX-FileCopyrightText: 2026 The bpa authors
// SPDX-License-Identifier: Apache-2.0
#include "server/web/http.hpp"

#include <gtest/gtest.h>

namespace bpa::server::web {
namespace {

TEST(Query, IsDecoded) {
  const auto values = parse_query("a=1&b=x%20y+z&c&d=%2e%2E%2f&a=2");
  ASSERT_TRUE(values.ok());
  EXPECT_EQ(*values, (std::map<std::string, std::string>{
                         {"a", "2"}, {"b", "x y z"}, {"c", ""}, {"d", "../"}}));
  EXPECT_TRUE(parse_query("")->empty());
}

TEST(Query, RefusesWhatIsMalformedOrTooMuch) {
  for (const char* wrong : {"a=%", "a=%4", "a=%zz", "%=1"}) {
    EXPECT_EQ(parse_query(wrong).status().code, StatusCode::invalid_argument) << wrong;
  }
  std::string many;
  for (int i = 0; i < 100; ++i) many += std::to_string(i) + "=1&";
  EXPECT_FALSE(parse_query(many).ok());
}

TEST(Refusal, SaysWhyInJson) {
  const Response response = refusal(Status(StatusCode::not_found, "no \"x\"\xff here"));
  EXPECT_EQ(response.status, 404);
  EXPECT_NE(response.body->find(R"("message":"no \"x\")"), std::string::npos);
  EXPECT_NE(response.body->find(R"("ok":false)"), std::string::npos);
}

}  // namespace
}  // namespace bpa::server::web
