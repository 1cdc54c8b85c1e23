// SPDX-FileCopyrightText: 2026 The bpa authors
// SPDX-License-Identifier: Apache-2.0
#include "server/options.hpp"

#include <filesystem>
#include <fstream>

#include <gtest/gtest.h>
#include <unistd.h>

namespace bpa::server {
namespace {

class OptionsFile : public testing::Test {
 protected:
  OptionsFile()
      : path((std::filesystem::temp_directory_path() /
              ("bpa_options_" + std::to_string(getpid()) + ".yaml"))
                 .string()) {}
  ~OptionsFile() override { std::filesystem::remove(path); }

  Status load(const std::string& text) {
    std::ofstream(path) << text;
    return load_options(path, options);
  }

  const std::string path;
  ServerOptions options;
};

TEST_F(OptionsFile, OverridesOnlyWhatItNames) {
  const Status status = load(
      "queue:\n  requests: 3\ninput:\n  color: ''\nnetwork: {peers: [10.0.0.7, camera]}\n"
      "node:\n  namespace: /left\n");
  ASSERT_TRUE(status.ok()) << status.message;
  EXPECT_EQ(options.queue.requests, 3);
  EXPECT_EQ(options.queue.frames, 1);
  EXPECT_EQ(options.input.color, "");
  EXPECT_EQ(options.network.peers, (std::vector<std::string>{"10.0.0.7", "camera"}));
  EXPECT_EQ(options.node.ros_namespace, "/left");
}

TEST_F(OptionsFile, EmptyFileChangesNothing) {
  EXPECT_TRUE(load("").ok());
  EXPECT_TRUE(load("queue:\n").ok());
  EXPECT_EQ(to_yaml(options), to_yaml(ServerOptions()));
}

TEST_F(OptionsFile, RefusesWithFileLineKeyAndRule) {
  const struct {
    const char* text;
    const char* line;
    std::vector<const char*> words;
  } cases[] = {
      {"queue:\n  frames: 2\n  request: 3\n", ":3:", {"unknown key queue.request", "requests"}},
      {"que:\n  frames: 2\n", ":1:", {"unknown key que", "queue"}},
      {"queue:\n  frames: 0\n", ":2:", {"queue.frames is 0", "between 1 and 100"}},
      {"queue:\n  frames: many\n", ":2:", {"queue.frames", "many", "whole number"}},
      {"queue:\n  frames: [1]\n", ":2:", {"queue.frames", "whole number"}},
      {"log:\n  level: loud\n", ":2:", {"log.level", "loud", "debug, info"}},
      {"queue: 3\n", ":1:", {"queue must hold"}},
      {"queue: [1\n", ":", {"not YAML"}},
  };
  for (const auto& c : cases) {
    const Status status = load(c.text);
    EXPECT_EQ(status.code, StatusCode::invalid_argument) << c.text;
    EXPECT_EQ(status.message.rfind(path + c.line, 0), 0U) << status.message;
    for (const char* word : c.words) {
      EXPECT_NE(status.message.find(word), std::string::npos) << status.message;
    }
  }
}

TEST_F(OptionsFile, MissingFileIsNotFound) {
  EXPECT_EQ(load_options("/nowhere.yaml", options).code, StatusCode::not_found);
}

TEST_F(OptionsFile, PrintedFileReadsBackTheSame) {
  options.queue.requests = 5;
  options.network.peers = {"a", "b"};
  options.detection.budget_ms = 12.5;
  options.output.tf = "";
  const std::string printed = to_yaml(options);
  options = {};
  ASSERT_TRUE(load(printed).ok());
  EXPECT_EQ(to_yaml(options), printed);
}

TEST(SetOption, SetsAndChecks) {
  ServerOptions options;
  EXPECT_TRUE(set_option("queue.requests=4", options).ok());
  EXPECT_EQ(options.queue.requests, 4);
  EXPECT_TRUE(set_option("input.color=", options).ok());
  EXPECT_EQ(options.input.color, "");
  EXPECT_FALSE(set_option("queue.requests", options).ok());
  EXPECT_FALSE(set_option("queue.reqests=4", options).ok());
  EXPECT_FALSE(set_option("queue.requests=-4", options).ok());
}

TEST(Config, ServerYamlShowsEveryKeyWithItsDefault) {
  std::ifstream file(BPA_SOURCE_DIR "/config/server.yaml");
  const std::string text{std::istreambuf_iterator<char>(file), {}};
  EXPECT_NE(text.find(to_yaml(ServerOptions())), std::string::npos)
      << "make config/server.yaml from bpa-server --print-config";
}

TEST(CaptureOptions, RulesNameTheField) {
  ServerOptions options;
  for (const char* good : {"openni2", "openni2:1d27/0601@1/5", "a/b.oni", "bop:set", ""}) {
    EXPECT_TRUE(set_option("capture.source=" + std::string(good), options).ok()) << good;
  }
  for (const auto& [setting, word] :
       {std::pair("capture.source=kinect", "capture.source"),
        std::pair("capture.depth_mode=vga", "capture.depth_mode"),
        std::pair("capture.registration=perhaps", "auto, device, software, off"),
        std::pair("capture.speed=0", "speed"), std::pair("detection.hang_s=-1", "hang_s")}) {
    ServerOptions changed;
    const Status status = set_option(setting, changed);
    EXPECT_EQ(status.code, StatusCode::invalid_argument) << setting;
    EXPECT_NE(status.message.find(word), std::string::npos) << status.message;
  }
}

TEST(CaptureOptions, AnOwnCameraHasNoSimulatedTime) {
  ServerOptions options;
  ASSERT_TRUE(set_option("node.use_sim_time=true", options).ok());
  const Status status = set_option("capture.source=openni2", options);
  EXPECT_EQ(status.code, StatusCode::invalid_argument);
  for (const char* word : {"node.use_sim_time", "capture.source", "openni2"}) {
    EXPECT_NE(status.message.find(word), std::string::npos) << status.message;
  }
}

}  // namespace
}  // namespace bpa::server
