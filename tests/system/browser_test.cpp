// SPDX-FileCopyrightText: 2026 The bpa authors
// SPDX-License-Identifier: Apache-2.0
#include "tests/support/browser.hpp"

#include <filesystem>
#include <fstream>
#include <set>

#include <gtest/gtest.h>
#include <nlohmann/json.hpp>

#include "tests/support/page_server.hpp"

// The page in a browser, before a real server that is fed by a data set. Pictures of it are left in
// the build tree, tests/page/.

namespace bpa {
namespace {

using nlohmann::json;
using std::chrono::seconds;
using support::Browser;
using support::PageServer;

std::string decoded_base64(const std::string& text) {
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

class Page : public testing::Test {
 protected:
  void SetUp() override {
    if (!Browser::is_installed()) GTEST_SKIP() << "chromium-driver is not installed";
    ASSERT_TRUE(support::SimulatedFrames::get().made);
    server = std::make_unique<PageServer>();
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

TEST_F(Page, ShowsWhatTheServerFound) {
  // Held, so that the page and the answer are about one result.
  browser->click("#timeline [role=option]");
  ASSERT_TRUE(browser->becomes(
      "return document.getElementById('of-result').textContent.includes('held');"));
  const std::string id =
      browser->run("return document.querySelector('#timeline [aria-selected=true]').dataset.id;");
  const json result = server->get("/api/results/" + id);
  ASSERT_FALSE(result.is_null()) << id;
  std::set<std::string> found;
  for (const json& p : result["result"]["interpretations"][0]["placements"])
    found.insert(p["model"]);
  EXPECT_EQ(shown(), found);
  // The 3-D view holds the cloud and each object; the pictures are not of one colour.
  EXPECT_TRUE(
      browser->becomes("const d = document.getElementById('space').dataset;"
                       "return d.points > 10000 && Number(d.objects) === arguments[0];",
                       {found.size()}));
  for (const char* name : {"color", "depth"}) {
    EXPECT_TRUE(
        browser->becomes("const c = document.getElementById(arguments[0]);"
                         "const p = c.getContext('2d').getImageData(0, 0, c.width, c.height).data;"
                         "return c.width >= 320 && new Set(p).size > 100;",
                         {name}))
        << name;
  }
  EXPECT_EQ(browser->errors(), std::vector<std::string>());
}

TEST_F(Page, ShowsTheSecondInterpretationAndAPlacementOfIt) {
  browser->click("#interpretations [data-rank='2']");
  EXPECT_TRUE(
      browser->becomes("return document.querySelector('#interpretations [data-rank=\"2\"]')"
                       ".getAttribute('aria-selected') === 'true';"));
  const std::string id =
      browser->run("return document.querySelector('#timeline [aria-selected=true]').dataset.id;");
  const json second = server->get("/api/results/" + id)["result"]["interpretations"][1];
  std::set<std::string> found;
  for (const json& placement : second["placements"]) found.insert(placement["model"]);
  EXPECT_EQ(shown(), found);
  browser->click("#placements [data-placement='0']");
  // The parts of the score add up to what the result says.
  EXPECT_TRUE(browser->becomes(
      "return document.querySelectorAll('#placements .score tbody tr').length > 5;"));
  const double sum =
      std::stod(browser
                    ->run("return document.querySelector('#placements .chosen').innerText"
                          ".match(/The score is (-?[0-9.]+)/)[1];")
                    .get<std::string>());
  EXPECT_NEAR(sum, second["placements"][0]["score"].get<double>(), 0.02);
  EXPECT_EQ(browser->errors(), std::vector<std::string>());
}

TEST_F(Page, ShowsTracksWhileTheyAreWanted) {
  browser->click("#show-tracks");
  EXPECT_TRUE(browser->becomes("return document.querySelectorAll('[data-track]').length > 0;"));
  browser->click("#show-tracks");
  EXPECT_TRUE(browser->becomes("return document.querySelectorAll('[data-track]').length === 0;"));
  EXPECT_EQ(browser->errors(), std::vector<std::string>());
}

TEST_F(Page, PutsInterpretationsThatHoldTheSameTogether) {
  // A box that looks the same when it is turned by 180 degrees about the z axis of its middle, and
  // a can that turns freely about z.
  const json models = {{{"name", "box"},
                        {"box_min", {0, 0, 0}},
                        {"box_max", {0.1, 0.1, 0.2}},
                        {"symmetry_turns_wxyz", {{0, 0, 0, 1}}},
                        {"symmetry_axes", json::array()}},
                       {{"name", "can"},
                        {"box_min", {-0.03, -0.03, 0}},
                        {"box_max", {0.03, 0.03, 0.1}},
                        {"symmetry_turns_wxyz", json::array()},
                        {"symmetry_axes", {{0, 0, 1}}}}};
  const auto at = [](const char* model, const json& position, const json& rotation) {
    return json{{"model", model},
                {"pose", {{"translation_m", position}, {"rotation_wxyz", rotation}}}};
  };
  const json upright = {1, 0, 0, 0}, half_turn = {0, 0, 0, 1}, quarter_turn = {0.6, 0, 0, 0.8};
  const json box = at("box", {0, 0, 1}, upright), can = at("can", {0.3, 0, 1}, upright);
  const auto of = [](int rank, double probability, const json& placements) {
    return json{{"rank", rank}, {"probability", probability}, {"placements", placements}};
  };
  const json interpretations = {
      of(1, 0.49, {box, can}),
      of(2, 0.001, {at("box", {0, 0, 1}, quarter_turn), can}),
      of(3, 0.42,
         {at("can", {0.304, 0, 1}, quarter_turn), at("box", {0.1, 0.1, 1.004}, half_turn)}),
      of(4, 0.01, {box, at("can", {0.3, 0, 1.02}, upright)}),
      of(5, 0.079, json::array({box})),
  };
  const json readings = browser->run(
      "const models = new Map(arguments[1].map((model) => [model.name, model]));"
      "return import('/readings.js').then(({readings}) => readings(arguments[0], models)"
      "  .map((one) => [one.members.map((member) => member.rank), one.probability]));",
      {interpretations, models});
  ASSERT_EQ(readings.size(), 4U) << readings;
  const json ranks = {{1, 3}, {5}, {4}, {2}};
  const double probabilities[] = {0.91, 0.079, 0.01, 0.001};
  for (std::size_t i = 0; i < 4; ++i) {
    EXPECT_EQ(readings[i][0], ranks[i]);
    EXPECT_NEAR(readings[i][1].get<double>(), probabilities[i], 1e-9);
  }
}

TEST_F(Page, SearchesTheRegionThatIsDrawn) {
  browser->click("#draw-region");
  browser->drag("#color", 0.2, 0.2, 0.8, 0.8);
  ASSERT_TRUE(browser->becomes(
      "return document.getElementById('of-result').textContent.includes('region');"))
      << server->log();
  const std::string id =
      browser->run("return document.querySelector('#timeline [aria-selected=true]').dataset.id;");
  const json result = server->get("/api/results/" + id);
  const json& camera = result.at("camera");
  for (const json& placement : result["result"]["interpretations"][0]["placements"]) {
    const json& t = placement["pose"]["translation_m"];
    const double x = (camera["fx"].get<double>() * t[0].get<double>() / t[2].get<double>() +
                      camera["cx"].get<double>()) /
                     camera["width"].get<double>();
    EXPECT_GT(x, 0.1);
    EXPECT_LT(x, 0.9);
  }
  browser->click("#draw-mask");
  browser->drag("#depth", 0.1, 0.1, 0.9, 0.5);
  // Two corners are no mask: the page says so.
  EXPECT_TRUE(browser->becomes("return !document.getElementById('notice').hidden;"));
}

TEST_F(Page, UnloadsAndLoadsAModel) {
  browser->click("#tab-models");
  ASSERT_TRUE(browser->becomes(
      "return document.querySelectorAll('#cards img').length === 4 &&"
      "[...document.querySelectorAll('#cards img')].every(i => i.naturalWidth > 0);"));
  save("laptop_models");
  browser->click("[data-unload=can]");
  ASSERT_TRUE(
      browser->becomes("return !document.querySelector('[data-model=can]') &&"
                       "!!document.querySelector('[data-load=can]');"));
  EXPECT_EQ(server->get("/api/models")["models"].size(), 3U);
  browser->click("[data-load=can]");
  EXPECT_TRUE(browser->becomes("return !!document.querySelector('[data-model=can]');"));
  // A threshold of 1 hides what is less than certain.
  browser->run(
      "const r = document.querySelector('[data-model=can] input[type=range]');"
      "r.value = 1; r.dispatchEvent(new Event('input')); return true;");
  EXPECT_TRUE(browser->becomes(
      "return document.querySelector('[data-kept=can]').textContent.startsWith('keeps 0 of');"));
}

TEST_F(Page, ShowsHealthAndChangesASetting) {
  browser->click("#tab-health");
  EXPECT_TRUE(
      browser->becomes("return !!document.querySelector('[data-status$=drops]') &&"
                       "document.getElementById('log').textContent.includes('capture') &&"
                       "Number(document.getElementById('stages').dataset.bars) > 0;"));
  save("laptop_health");
  browser->click("#tab-settings");
  ASSERT_TRUE(browser->becomes("return !!document.getElementById('set-detection.top_k');"));
  const auto set = [this](const char* value) {
    browser->run(
        "const i = document.getElementById('set-detection.top_k'); i.value = arguments[0];"
        "i.dispatchEvent(new Event('change')); return true;",
        {value});
  };
  set("7");
  EXPECT_TRUE(browser->becomes(
      "return document.getElementById('notice').textContent === 'detection.top_k is 7';"));
  set("0");
  EXPECT_TRUE(browser->becomes(
      "return document.getElementById('notice').textContent.includes('between 1 and 100');"));
  save("laptop_settings");
}

TEST_F(Page, SaysThatItLostTheServerAndComesBack) {
  EXPECT_TRUE(connection_is("connected"));
  const int port = server->port();
  server->stop();
  EXPECT_TRUE(connection_is("lost"));
  save("laptop_lost");
  browser->run("document.getElementById('placements').replaceChildren(); return true;");
  server->start(std::to_string(port));
  ASSERT_EQ(server->port(), port) << server->log();
  EXPECT_TRUE(connection_is("connected"));
  EXPECT_TRUE(browser->becomes(kHasObjects));
}

TEST_F(Page, FitsAnyScreen) {
  const struct {
    const char* name;
    int width, height;
    bool dark;
  } screens[] = {{"laptop", 1440, 1000, false},
                 {"laptop_dark", 1280, 800, true},
                 {"phone", 390, 844, false},
                 {"phone_dark", 360, 740, true}};
  browser->click("#interpretations [data-rank='1']");
  browser->click("#placements [data-placement='0']");
  for (const auto& screen : screens) {
    browser->resize(screen.width, screen.height, screen.dark);
    for (const char* tab : {"models", "health", "settings", "live"}) {
      browser->click("#tab-" + std::string(tab));
      EXPECT_TRUE(
          browser->becomes("return document.documentElement.scrollWidth <= window.innerWidth;",
                           json::array(), seconds(5)))
          << screen.name << ' ' << tab;
    }
    browser->becomes("return Number(document.getElementById('space').dataset.points) > 0;");
    browser->run("window.scrollTo(0, 0); return new Promise(r => setTimeout(r, 500));");
    save(screen.name);
  }
  // The keyboard alone: from tab to tab.
  browser->run(
      "document.getElementById('tab-live').focus();"
      "document.getElementById('tab-live').dispatchEvent("
      "new KeyboardEvent('keydown', {key: 'ArrowRight', bubbles: true})); return true;");
  EXPECT_TRUE(browser->becomes("return document.activeElement.id === 'tab-models';"));
}

}  // namespace
}  // namespace bpa
