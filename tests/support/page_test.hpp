// SPDX-FileCopyrightText: 2026 The bpa authors
// SPDX-License-Identifier: Apache-2.0
#pragma once

#include <filesystem>
#include <fstream>
#include <memory>
#include <set>
#include <string>
#include <vector>

#include <gtest/gtest.h>

#include "tests/support/browser.hpp"
#include "tests/support/page_server.hpp"

// A test of the page in a browser. Pictures of it are left in the build tree, tests/page/.

namespace bpa::support {

inline std::string decoded_base64(const std::string& text) {
  const std::string digits = "ABCDEFGHIJKLMNOPQRSTUVWXYZabcdefghijklmnopqrstuvwxyz0123456789+/";
  std::string bytes;
  unsigned value = 0;
  int bits = 0;
  for (const char c : text) {
    const std::size_t digit = digits.find(c);
    if (digit == std::string::npos) break;
    value = value << 6U | static_cast<unsigned>(digit);
    bits += 6;
    if (bits < 8) continue;
    bits -= 8;
    bytes += static_cast<char>(value >> static_cast<unsigned>(bits) & 0xffU);
  }
  return bytes;
}

/// Skipped where no browser is installed.
class PageTest : public testing::Test {
 protected:
  void SetUp() override {
    if (!Browser::is_installed()) GTEST_SKIP() << "chromium-driver is not installed";
    ASSERT_TRUE(support::SimulatedFrames::get().made);
  }
  /// The page of a server with these options, once it shows objects.
  void open(const std::vector<std::string>& more = {}, const std::string& sensor = "",
            const std::string& listen = "0") {
    server = std::make_unique<PageServer>(listen, more, sensor);
    ASSERT_GT(server->port(), 0) << server->log();
    browser = std::make_unique<Browser>();
    browser->open(server->address());
    ASSERT_TRUE(browser->becomes(kHasObjects)) << server->log();
  }

  /// What the placements' cards say, by name.
  std::set<std::string> shown() {
    return browser->run(
        "return [...document.querySelectorAll('#placements h3 button')].map(b => b.textContent);");
  }
  /// The number of the result that the page shows; the time line may have moved on.
  std::string shown_result() {
    return browser->run("return document.getElementById('of-result').dataset.id;");
  }
  void save(const std::string& name) {
    const std::string folder = BPA_BINARY_DIR "/tests/page";
    std::filesystem::create_directories(folder);
    std::ofstream(folder + "/" + name + ".png", std::ios::binary)
        << decoded_base64(browser->screenshot());
  }
  bool connection_is(const std::string& state) {
    return browser->becomes(
        "return document.getElementById('connection').dataset.state === arguments[0];", {state});
  }

  static constexpr const char* kHasObjects =
      "return document.querySelectorAll('#placements .placement').length > 0;";
  std::unique_ptr<PageServer> server;
  std::unique_ptr<Browser> browser;
};

}  // namespace bpa::support
