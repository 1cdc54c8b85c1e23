// SPDX-FileCopyrightText: 2026 The bpa authors
// SPDX-License-Identifier: Apache-2.0
#include <algorithm>
#include <filesystem>
#include <fstream>
#include <set>

#include <gtest/gtest.h>
#include <nlohmann/json.hpp>
#include <sys/stat.h>

#include "tests/support/page_server.hpp"
#include "tests/support/stub_server.hpp"

// What a real server answers over HTTP, compared with what it says over DDS and what bpa finds.

namespace bpa {
namespace {

using nlohmann::json;
using std::chrono::seconds;
using support::PageServer;

/// Names of the best interpretation's objects.
std::set<std::string> objects_of(const json& result) {
  std::set<std::string> names;
  for (const json& placement : result.at("interpretations").at(0).at("placements")) {
    names.insert(placement.at("model"));
  }
  return names;
}

class Web : public testing::Test {
 protected:
  void SetUp() override { ASSERT_TRUE(support::SimulatedFrames::get().made); }

  /// Everything of the result that a search gives.
  json search(const PageServer& server, const std::string& path, const std::string& body) {
    const auto answer = server.post(path, body);
    EXPECT_EQ(answer.status, 200) << answer.body << server.log();
    if (answer.status != 200) return nullptr;
    return server.get("/api/results/" + json::parse(answer.body).at("result").dump());
  }
};

TEST_F(Web, WhatItSavesIsReadByBpaDetect) {
  PageServer server;
  ASSERT_GT(server.port(), 0) << server.log();
  const json found = search(server, "/api/search", R"({"seed": 0})");
  ASSERT_FALSE(found.is_null());
  const std::string id = found.at("id").dump();
  const auto archive = support::http(server.port(), "GET", "/api/results/" + id + "/archive");
  ASSERT_EQ(archive.status, 200);
  const std::string folder = support::scratch_folder() + "/saved";
  std::filesystem::create_directories(folder);
  std::ofstream(folder + "/frame.tar", std::ios::binary) << archive.body;
  const std::string log = support::scratch_folder() + "/detect.log";
  ASSERT_EQ(support::run({"/bin/tar", "-xf", folder + "/frame.tar", "-C", folder}, log), 0);
  ASSERT_EQ(support::run({BPA_BINARY_DIR "/bin/bpa", "detect", "--library",
                          support::SimulatedFrames::get().library, "--depth", folder + "/depth.png",
                          "--color", folder + "/color.png", "--camera", folder + "/camera.json",
                          "--json", folder + "/again.json"},
                         log, seconds(120)),
            0)
      << support::read_text(log);
  const json saved = json::parse(std::ifstream(folder + "/result.json"));
  const json again = json::parse(std::ifstream(folder + "/again.json"));
  EXPECT_EQ(saved.at("frames").at(0).at("interpretations"),
            found.at("result").at("interpretations"));
  EXPECT_EQ(objects_of(again.at("frames").at(0)), objects_of(found.at("result")));

  // The same pair, uploaded.
  const std::string depth = support::read_text(folder + "/depth.png");
  const std::string color = support::read_text(folder + "/color.png");
  const json camera = json::parse(std::ifstream(folder + "/camera.json"));
  const json uploaded = search(server,
                               "/api/upload?kind=png&depth_bytes=" + std::to_string(depth.size()) +
                                   "&fx=" + camera["fx"].dump() + "&fy=" + camera["fy"].dump() +
                                   "&cx=" + camera["cx"].dump() + "&cy=" + camera["cy"].dump(),
                               depth + color);
  ASSERT_FALSE(uploaded.is_null());
  EXPECT_EQ(uploaded.at("origin"), "upload");
  EXPECT_EQ(objects_of(uploaded.at("result")), objects_of(found.at("result")));

  const json near =
      search(server,
             "/api/upload?kind=png&depth_scale_mm=0.1&depth_bytes=" + std::to_string(depth.size()) +
                 "&fx=" + camera["fx"].dump() + "&fy=" + camera["fy"].dump() +
                 "&cx=" + camera["cx"].dump() + "&cy=" + camera["cy"].dump(),
             depth + color);
  ASSERT_FALSE(near.is_null());
  EXPECT_NE(near.at("advice").dump().find("the scene is too near"), std::string::npos) << near;
  // Who asks over DDS is told the same.
  const std::vector<std::uint16_t> too_near(640 * 480, 90);
  FrameView view;
  view.width = 640;
  view.height = 480;
  view.depth_mm = too_near.data();
  view.fx = view.fy = 525;
  view.cx = 319.5;
  view.cy = 239.5;
  auto client = Client::connect(support::client_options());
  ASSERT_TRUE(client.ok()) << client.status().message;
  const auto nothing = client->detect_in(view);
  ASSERT_TRUE(nothing.ok()) << nothing.status().message;
  EXPECT_TRUE(nothing->status.ok());
  EXPECT_NE(nothing->status.message.find("the scene is too near"), std::string::npos)
      << nothing->status.message;

  // A region around one object holds that one alone.
  const json& first = found.at("result").at("interpretations").at(0).at("placements").at(0);
  const json outlines = server.get("/api/results/" + uploaded.at("id").dump() + "/outlines");
  ASSERT_TRUE(outlines.is_array());
  // A rank that is not there is refused in the same words everywhere.
  const std::string of = "/api/results/" + uploaded.at("id").dump();
  const auto no_outlines = support::http(server.port(), "GET", of + "/outlines?rank=99");
  const auto no_score = support::http(server.port(), "GET", of + "/score?rank=99&placement=0");
  EXPECT_EQ(no_outlines.status, 404);
  EXPECT_NE(no_outlines.body.find("rank is 99"), std::string::npos) << no_outlines.body;
  EXPECT_EQ(no_score.body, no_outlines.body);
  const auto no_placement = support::http(server.port(), "GET", of + "/score?placement=50");
  EXPECT_NE(no_placement.body.find("placement is 50"), std::string::npos) << no_placement.body;
  const auto one = std::ranges::find_if(
      outlines, [&](const json& outline) { return outline.at("model") == first.at("model"); });
  ASSERT_NE(one, outlines.end());
  const json& polygon = one->at("outline").at(0);
  int low[2] = {10000, 10000}, high[2] = {0, 0};
  for (std::size_t i = 0; i < polygon.size(); ++i) {
    low[i % 2] = std::min(low[i % 2], polygon[i].get<int>() - 5);
    high[i % 2] = std::max(high[i % 2], polygon[i].get<int>() + 5);
  }
  const json region = {std::max(0, low[0]), std::max(0, low[1]), high[0] - low[0],
                       high[1] - low[1]};
  const json there = search(server, "/api/search?result=" + uploaded.at("id").dump(),
                            json({{"region", region}, {"models", {first.at("model")}}}).dump());
  ASSERT_FALSE(there.is_null());
  EXPECT_EQ(objects_of(there.at("result")), std::set<std::string>{first.at("model")});
}

TEST_F(Web, ChangesAreThoseOfTheServices) {
  PageServer server;
  ASSERT_GT(server.port(), 0) << server.log();
  auto client = Client::connect(support::client_options());
  ASSERT_TRUE(client.ok()) << client.status().message;
  const auto names = [&] {
    std::set<std::string> loaded;
    const auto models = client->models();
    if (!models.ok()) return loaded;
    for (const auto& model : *models) loaded.insert(model.name);
    return loaded;
  };
  EXPECT_EQ(names(), (std::set<std::string>{"mug", "can", "cereal_box", "banana"}));
  EXPECT_EQ(server.post("/api/models/can/unload", "{}").status, 200);
  EXPECT_EQ(names(), (std::set<std::string>{"mug", "cereal_box", "banana"}));
  EXPECT_EQ(server.get("/api/models").at("not_loaded"), json({"can"}));
  EXPECT_EQ(server.post("/api/models/can/unload", "{}").status, 404);
  EXPECT_EQ(server.post("/api/models/can/load", "{}").status, 200);
  EXPECT_EQ(names().count("can"), 1U);
  EXPECT_EQ(server.post("/api/models/none/load", "{}").status, 404);
  EXPECT_EQ(server.post("/api/models/..%2fcan/load", "{}").status, 400);

  EXPECT_EQ(
      server.post("/api/parameters", R"({"name": "detection.continuous", "value": false})").status,
      200);
  const auto status = client->status();
  ASSERT_TRUE(status.ok());
  EXPECT_EQ(status->state, "paused");
  const auto refused = server.post("/api/parameters", R"({"name": "detection.top_k", "value": 0})");
  EXPECT_EQ(refused.status, 400);
  EXPECT_NE(refused.body.find("between 1 and 100"), std::string::npos) << refused.body;
  EXPECT_EQ(server.post("/api/parameters", R"({"name": "web.listen", "value": "1"})").status, 400);
  const auto record = server.post("/api/record", R"({"path": "a.oni", "seconds": 1})");
  EXPECT_EQ(record.status, 422);
  EXPECT_NE(record.body.find("capture.record_folder"), std::string::npos) << record.body;
}

TEST_F(Web, AsksForTheTokenOfItsFile) {
  const std::string path = support::scratch_folder() + "/token";
  std::ofstream(path) << "a-token-of-some-length\n";
  chmod(path.c_str(), 0600);
  PageServer server("0", {"--set", "web.token_file=" + path});
  ASSERT_GT(server.port(), 0) << server.log();
  const auto status = [&](const std::string& target, const std::string& authorization) {
    return support::http(server.port(), "GET", target, "", {{"Authorization", authorization}})
        .status;
  };
  EXPECT_EQ(status("/", ""), 200);
  EXPECT_EQ(status("/api/models", ""), 401);
  EXPECT_EQ(status("/api/models", "Bearer another-token-of-some"), 401);
  EXPECT_EQ(status("/api/models", "Bearer a-token-of-some-length"), 200);
  EXPECT_EQ(status("Xapi/models", ""), 400);
  EXPECT_EQ(status("//api/models", ""), 401);
  EXPECT_EQ(server.log().find("a-token"), std::string::npos);
  server.stop();
  chmod(path.c_str(), 0644);
  support::Process open(
      support::own_command("bpa-server", {"--library", support::SimulatedFrames::get().library,
                                          "--web", "0", "--set", "web.token_file=" + path}),
      path + ".log");
  EXPECT_EQ(open.wait(seconds(30)), 1);
  EXPECT_NE(support::read_text(path + ".log").find("0600"), std::string::npos);
}

TEST_F(Web, MakesATokenForOtherMachinesAndTellsTheTerminalAlone) {
  PageServer server("0.0.0.0:0");
  ASSERT_GT(server.port(), 0) << server.log();
  const std::size_t at = server.address().find("#token=");
  ASSERT_NE(at, std::string::npos) << server.address();
  const std::string token = server.address().substr(at + 7);
  EXPECT_EQ(token.size(), 32U);
  EXPECT_EQ(support::http(server.port(), "GET", "/api/health").status, 401);
  const auto health = support::http(server.port(), "GET", "/api/health", "",
                                    {{"Authorization", "Bearer " + token}});
  EXPECT_EQ(health.status, 200);
  EXPECT_EQ(health.body.find(token), std::string::npos);  // not in the log that the page shows
  // "no token" is counted.
  EXPECT_NE(health.body.find(R"(["web: requests refused: no token","1"])"), std::string::npos);
}

}  // namespace
}  // namespace bpa
