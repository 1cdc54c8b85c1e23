// SPDX-FileCopyrightText: 2026 The bpa authors
// SPDX-License-Identifier: Apache-2.0
#pragma once

#include <array>
#include <chrono>
#include <functional>
#include <memory>
#include <regex>
#include <stdexcept>
#include <string>
#include <thread>
#include <vector>

#include <nlohmann/json.hpp>
#include <unistd.h>

#include "tests/support/http_client.hpp"
#include "tests/support/process.hpp"

namespace bpa::support {

/// Chromium without a screen, driven through chromedriver (W3C WebDriver). What fails throws a
/// std::runtime_error.
class Browser {
 public:
  using Json = nlohmann::json;
  static constexpr const char* kDriver = "/usr/bin/chromedriver";
  static bool is_installed() { return access(kDriver, X_OK) == 0; }

  Browser()
      : log_path_(scratch_folder() + "/chromedriver.log"),
        driver_(std::vector<std::string>{kDriver, "--port=0"}, log_path_) {
    std::smatch found;
    std::string log;
    const std::regex port(R"(started successfully on port (\d+))");
    if (!until([&] { return std::regex_search(log = read_text(log_path_), found, port); })) {
      throw std::runtime_error("chromedriver did not start: " + log);
    }
    port_ = std::stoi(found[1]);
    const Json chrome = {
        {"args",
         {"--headless=new", "--no-sandbox", "--disable-dev-shm-usage", "--use-angle=swiftshader",
          "--enable-unsafe-swiftshader", "--window-size=1440,1000"}}};
    const Json wanted = {{"browserName", "chrome"},
                         {"goog:chromeOptions", chrome},
                         {"goog:loggingPrefs", {{"browser", "ALL"}}}};
    session_ = "/session/" + call("POST", "/session", {{"capabilities", {{"alwaysMatch", wanted}}}})
                                 .at("sessionId")
                                 .get<std::string>();
  }
  ~Browser() { support::http(port_, "DELETE", session_); }

  void open(const std::string& url) { in_session("POST", "/url", {{"url", url}}); }
  /// The value of "return ...;" in the page.
  Json run(const std::string& script, const Json& arguments = Json::array()) {
    return in_session("POST", "/execute/sync", {{"script", script}, {"args", arguments}});
  }
  void click(const std::string& selector) {
    if (!run("const e = document.querySelector(arguments[0]); if (e) e.click(); return !!e;",
             {selector})
             .get<bool>()) {
      throw std::runtime_error("there is nothing to click at " + selector);
    }
  }
  /// Drags the mouse over points of an element, in shares of its size.
  void drag(const std::string& selector, const std::vector<std::array<double, 2>>& points) {
    const Json box =
        run("const e = document.querySelector(arguments[0]); e.scrollIntoView({block: 'center'});"
            "const b = e.getBoundingClientRect(); return [b.left, b.top, b.width, b.height];",
            {selector});
    Json steps = Json::array();
    for (const auto& [x, y] : points) {
      steps.push_back({{"type", "pointerMove"},
                       {"duration", steps.empty() ? 0 : 200},
                       {"x", static_cast<int>(box[0].get<double>() + x * box[2].get<double>())},
                       {"y", static_cast<int>(box[1].get<double>() + y * box[3].get<double>())}});
      if (steps.size() == 1) steps.push_back({{"type", "pointerDown"}, {"button", 0}});
    }
    steps.push_back({{"type", "pointerUp"}, {"button", 0}});
    in_session("POST", "/actions",
               {{"actions", {{{"type", "pointer"}, {"id", "mouse"}, {"actions", steps}}}}});
  }
  /// Puts text, or a file's path, into an input.
  void type(const std::string& selector, const std::string& text) {
    const Json element =
        in_session("POST", "/element", {{"using", "css selector"}, {"value", selector}});
    in_session("POST", "/element/" + element.begin()->get<std::string>() + "/value",
               {{"text", text}});
  }
  /// Presses and lets go a key of the element that has the focus, as WebDriver writes keys.
  void press(const std::string& key) {
    const Json steps = {{{"type", "keyDown"}, {"value", key}}, {{"type", "keyUp"}, {"value", key}}};
    in_session("POST", "/actions",
               {{"actions", {{{"type", "key"}, {"id", "keys"}, {"actions", steps}}}}});
  }
  /// As a screen of this size, a phone's where it is narrow.
  void resize(int width, int height, bool dark = false) {
    const Json size = {
        {"width", width}, {"height", height}, {"deviceScaleFactor", 1}, {"mobile", width < 600}};
    devtools("Emulation.setDeviceMetricsOverride", size);
    const Json scheme = {{"name", "prefers-color-scheme"}, {"value", dark ? "dark" : "light"}};
    devtools("Emulation.setEmulatedMedia", {{"features", {scheme}}});
  }
  /// A PNG of what is seen, in base64.
  std::string screenshot() { return in_session("GET", "/screenshot").get<std::string>(); }
  /// What the page said to the console since the last call: errors and refused loads.
  std::vector<std::string> errors() {
    std::vector<std::string> errors;
    for (const Json& line : in_session("POST", "/se/log", {{"type", "browser"}})) {
      if (line.at("level") == "SEVERE") errors.push_back(line.at("message"));
    }
    return errors;
  }
  /// Whether a script returns true in time.
  bool becomes(const std::string& script, const Json& arguments = Json::array(),
               std::chrono::seconds time = std::chrono::seconds(30)) {
    return until([&] { return run(script, arguments) == true; }, time);
  }

 private:
  static bool until(const std::function<bool()>& condition,
                    std::chrono::seconds time = std::chrono::seconds(30)) {
    const auto end = std::chrono::steady_clock::now() + time;
    while (!condition()) {
      if (std::chrono::steady_clock::now() > end) return false;
      std::this_thread::sleep_for(std::chrono::milliseconds(100));
    }
    return true;
  }
  Json call(const std::string& method, const std::string& path, const Json& body = nullptr) {
    const HttpAnswer answer =
        support::http(port_, method, path, body.is_null() ? "" : body.dump(),
                      {{"Content-Type", "application/json"}}, std::chrono::seconds(60));
    const Json json = Json::parse(answer.body, nullptr, false);
    if (answer.status != 200 || !json.contains("value")) {
      throw std::runtime_error(method + " " + path + ": " + answer.body.substr(0, 500));
    }
    return json.at("value");
  }
  Json in_session(const std::string& method, const std::string& path, const Json& body = nullptr) {
    return call(method, session_ + path, body);
  }
  void devtools(const std::string& command, const Json& parameters) {
    in_session("POST", "/goog/cdp/execute", {{"cmd", command}, {"params", parameters}});
  }

  std::string log_path_;
  Process driver_;
  int port_ = 0;
  std::string session_;
};

}  // namespace bpa::support
