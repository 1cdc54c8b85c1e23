// SPDX-FileCopyrightText: 2026 The bpa authors
// SPDX-License-Identifier: Apache-2.0
#include <filesystem>
#include <fstream>
#include <set>

#include <gtest/gtest.h>
#include <nlohmann/json.hpp>

#include "idl/wire/messages.hpp"
#include "idl/wire/publisher.hpp"
#include "tests/support/page_test.hpp"

// The page in a browser, before a real server that is fed by a data set or a simulated sensor.

namespace bpa {
namespace {

namespace fs = std::filesystem;
using nlohmann::json;
using std::chrono::seconds;
using AnyPage = support::PageTest;

/// The simulated frames are shown over and over.
class Page : public AnyPage {
 protected:
  void SetUp() override {
    AnyPage::SetUp();
    if (!IsSkipped()) open();
  }
};

TEST_F(Page, ShowsWhatTheServerFound) {
  // Held, so that the page and the answer are about one result, which the server keeps.
  browser->click("#timeline [role=option]:last-child");
  ASSERT_TRUE(browser->becomes(
      "return document.getElementById('of-result').textContent.includes('held');"));
  const std::string id = shown_result();
  const json result = server->get("/api/results/" + id);
  ASSERT_FALSE(result.is_null()) << id;
  std::set<std::string> found;
  for (const json& p : result["result"]["interpretations"][0]["placements"])
    found.insert(p["model"]);
  EXPECT_EQ(shown(), found);
  const auto missed =
      browser->run("return document.getElementById('missed').textContent;").get<std::string>();
  ASSERT_FALSE(result["result"]["missed"].empty());
  for (const json& one : result["result"]["missed"]) {
    const bool named = missed.find(' ' + one["model"].get<std::string>() + ' ') != missed.npos;
    EXPECT_EQ(named, one["expected"].get<double>() >= 0.05) << one << missed;
  }
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
  const std::string id = shown_result();
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
  browser->click("#show-cloud");  // to draw it without a graphics card takes time from the tracker
  browser->click("#show-tracks");
  EXPECT_TRUE(browser->becomes("return document.querySelectorAll('[data-track]').length > 0;",
                               json::array(), seconds(60)));
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

TEST_F(AnyPage, DrawsTracksOfAFixedFrameWhereTheCameraSeesThem) {
  auto robot = support::test_participant("robot");
  ASSERT_TRUE(robot.ok());
  auto transforms = wire::Publisher<wire::tf2_msgs::TFMessage>::create(
      *robot, "tf_static", {wire::qos::static_transforms()});
  ASSERT_TRUE(transforms.ok());
  wire::tf2_msgs::TFMessage mount;  // far from where the camera is in its own frame, and turned
  mount.transforms.resize(1);
  mount.transforms[0].header.frame_id = "map";
  mount.transforms[0].child_frame_id = "camera_color_optical_frame";
  mount.transforms[0].transform.translation = {1.5, -2, 0.7};
  mount.transforms[0].transform.rotation = {0.1, -0.5, 0.7, 0.5};
  ASSERT_TRUE(transforms->publish(mount).ok());
  open({"--set", "tracking.fixed_frame=map", "--set", "tracking.tf_wait_ms=1000", "--set",
        "input.tf=tf", "--set", "input.tf_static=tf_static", "--set", "web.rate_hz=2"},
       support::sensor_of_one_frame());
  browser->click("#show-cloud");  // as above
  browser->click("#show-tracks");
  ASSERT_TRUE(
      browser->becomes("return [...document.querySelectorAll('[data-track]')]"
                       ".filter(row => row.innerText.includes('confirmed')).length > 1;",
                       json::array(), seconds(90)))
      << server->get("/api/health").at("diagnostics") << server->log();
  browser->click("#timeline [role=option]:last-child");  // held
  // Where the 3-D view has them; its y and z axes are against the camera's.
  const json drawn = browser->run(
      "return import('/view3d.js').then(({tracks}) => {"
      "  const found = {};"
      "  tracks.updateMatrixWorld(true);"
      "  tracks.traverse((one) => {"
      "    const m = one.matrixWorld.elements;"
      "    if (one.name) found[one.name] = [m[12], -m[13], -m[14]];"
      "  });"
      "  return found;"
      "});");
  const std::string id = shown_result();
  const json result = server->get("/api/results/" + id);
  ASSERT_FALSE(result.is_null());
  int compared = 0;
  for (const json& placement : result["result"]["interpretations"][0]["placements"]) {
    const auto track = drawn.find(placement["model"].get<std::string>() + "_1");
    if (track == drawn.end()) continue;
    const json& camera = placement["pose"]["translation_m"];
    for (int i = 0; i < 3; ++i) {
      EXPECT_NEAR((*track)[i].get<double>(), camera[i].get<double>(), 0.02) << drawn << placement;
    }
    ++compared;
  }
  EXPECT_GT(compared, 1) << drawn;
  browser->click("#show-cloud");
  browser->run("document.getElementById('space').scrollIntoView(); return true;");
  browser->run("return new Promise(done => setTimeout(done, 1000));");
  save("laptop_tracks");
  EXPECT_EQ(browser->errors(), std::vector<std::string>());
}

TEST_F(AnyPage, RecordsTheServersCamera) {
  const std::string folder = support::sensor_of_one_frame();
  open({"--set", "capture.record_folder=" + folder}, folder);
  browser->click("#open-more");
  browser->run("document.getElementById('record-path').value = 'page.oni'; return true;");
  const auto says = [this](const std::string& words) {
    return browser->becomes(
        "return document.getElementById('notice').textContent.includes(arguments[0]);", {words});
  };
  browser->click("#record-start");
  ASSERT_TRUE(says("Recording to " + folder + "/page.oni")) << server->log();
  save("laptop_recording");
  browser->click("#record-start");  // there is one already
  EXPECT_TRUE(browser->becomes(
      "return !document.getElementById('notice').textContent.includes('Recording to');"));
  browser->click("#record-stop");
  ASSERT_TRUE(says(" frames, ")) << server->log();
  const int frames = std::stoi(
      browser->run("return document.getElementById('notice').textContent;").get<std::string>());
  EXPECT_GT(frames, 3);
  server->stop();

  // What OpenNI2 reads of it: as many frames, with the sensor's pixels.
  const std::string log = support::scratch_folder() + "/look.log";
  ASSERT_EQ(support::run(support::with_sensor(
                             "", {BPA_BINARY_DIR "/tests/openni2_look", folder + "/page.oni", "3"}),
                         log),
            0)
      << support::read_text(log);
  const std::string count = std::to_string(frames);
  EXPECT_NE(support::read_text(log).find("holds " + count + " depth and " + count + " color"),
            std::string::npos)
      << frames << support::read_text(log);
  const auto depth = io::read_gray_png(folder + "/test/000001/depth/000000.png");
  ASSERT_TRUE(depth.ok()) << depth.status().message;
  const auto middle = static_cast<std::size_t>(depth->height / 2 * depth->width + depth->width / 2);
  EXPECT_NE(support::read_text(log).find("middle " + std::to_string(depth->pixels[middle])),
            std::string::npos)
      << depth->pixels[middle] << support::read_text(log);
}

TEST_F(Page, SearchesTheRegionThatIsDrawn) {
  browser->click("#draw-region");
  browser->drag("#color", {{0.2, 0.2}, {0.8, 0.8}});
  ASSERT_TRUE(browser->becomes(
      "return document.getElementById('of-result').textContent.includes('region');"))
      << server->log();
  const std::string id = shown_result();
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
  browser->drag("#depth", {{0.1, 0.1}, {0.9, 0.1}, {0.9, 0.9}, {0.1, 0.9}});
  ASSERT_TRUE(
      browser->becomes("const id = document.getElementById('of-result').dataset.id;"
                       "return Number(id) > Number(arguments[0]);",
                       {id}))
      << server->log();
  EXPECT_FALSE(shown().empty());
  browser->click("#draw-mask");
  browser->drag("#depth", {{0.1, 0.1}, {0.1, 0.1}});
  // One corner is no mask: the page says so.
  EXPECT_TRUE(browser->becomes("return !document.getElementById('notice').hidden;"));
}

TEST_F(Page, PausesSearchesOneFrameAndGoesOn) {
  const auto figure_is = [this](const char* words) {
    return browser->becomes(
        "return document.querySelector('[data-figure=State]').textContent === arguments[0];",
        {words});
  };
  browser->click("#pause");
  EXPECT_TRUE(figure_is("paused"));
  browser->click("#one-frame");
  EXPECT_TRUE(browser->becomes(
      "return document.getElementById('of-result').textContent.includes('next frame');"));
  browser->click("#pause");
  EXPECT_TRUE(figure_is("running"));
}

TEST_F(Page, SearchesTheFilesThatAreUploaded) {
  const std::string scene = support::SimulatedFrames::get().frames + "/test/000001";
  browser->click("#pause");
  browser->click("#open-more");
  browser->type("#upload-depth", scene + "/depth/000000.png");
  browser->type("#upload-color", scene + "/rgb/000000.png");
  const json cameras = json::parse(support::read_text(scene + "/scene_camera.json"));
  const std::string camera = support::scratch_folder() + "/camera.json";
  std::ofstream(camera) << cameras.at("0");
  browser->type("#upload-camera", camera);
  browser->click("#upload");
  EXPECT_TRUE(browser->becomes(
      "return document.getElementById('of-result').textContent.includes('upload');"))
      << server->log();
  EXPECT_FALSE(shown().empty());
}

TEST_F(AnyPage, AsksForTheTokenThatOnlyTheTerminalHas) {
  open({}, "", "0.0.0.0:0");  // at the address that the server printed
  EXPECT_EQ(browser->run("return location.hash;"), "");
  browser->open("http://127.0.0.1:" + std::to_string(server->port()));  // has no token
  EXPECT_TRUE(connection_is("token"));
  EXPECT_TRUE(shown().empty());
  const std::string& address = server->address();
  browser->type("#token", address.substr(address.find('=') + 1));
  browser->click("#token-form button");
  EXPECT_TRUE(connection_is("connected"));
  EXPECT_TRUE(browser->becomes(kHasObjects)) << server->log();
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

/// The mug under another name, in the folder of the library while this exists.
class SecondMug {
 public:
  SecondMug() {
    const fs::path library = support::SimulatedFrames::get().library;
    fs::copy(library / "mug", folder_);
    const std::string model = folder_ / "model.json";
    json description = json::parse(support::read_text(model));
    description["name"] = "tankard";
    description["number"] = 99;
    std::ofstream(model) << description;
  }
  ~SecondMug() { fs::remove_all(folder_); }
  SecondMug(const SecondMug&) = delete;
  SecondMug& operator=(const SecondMug&) = delete;

 private:
  const fs::path folder_ = fs::path(support::SimulatedFrames::get().library) / "tankard";
};

TEST_F(AnyPage, FindsModelsThatLookAlike) {
  const SecondMug second;
  open();
  browser->click("#tab-models");
  ASSERT_TRUE(browser->becomes("return !!document.querySelector('[data-model=tankard]');"));
  browser->click("#compare");
  const std::string state = "return document.getElementById('compare-state').textContent";
  EXPECT_TRUE(browser->becomes(state + " === '1 pair looks alike';")) << server->log();
  const std::string warned =
      "return [...document.querySelectorAll('#cards .warn')]"
      ".map(list => list.closest('.card').dataset.model).sort().join();";
  EXPECT_EQ(browser->run(warned), "mug,tankard");
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
}

TEST_F(Page, IsUsedByTheKeyboardAlone) {
  constexpr const char* kRight = "\uE014";
  constexpr const char* kDown = "\uE015";
  const auto focus = [this](const char* id) {
    browser->run("document.getElementById(arguments[0]).focus(); return true;", {id});
  };
  focus("interpretations");
  browser->press(kDown);
  EXPECT_TRUE(browser->becomes(
      "const all = [...document.querySelectorAll('#interpretations [role=option]')];"
      "return all[1].getAttribute('aria-selected') === 'true';"));
  focus("tab-live");
  browser->press(kRight);
  EXPECT_TRUE(browser->becomes("return document.activeElement.id === 'tab-models';"));
}

}  // namespace
}  // namespace bpa
