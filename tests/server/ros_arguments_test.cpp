// SPDX-FileCopyrightText: 2026 The bpa authors
// SPDX-License-Identifier: Apache-2.0
#include "server/ros_arguments.hpp"

#include <fstream>

#include <gtest/gtest.h>

#include "tests/support/temporary_folder.hpp"

namespace bpa::server {
namespace {

Result<ServerOptions> read(const std::vector<std::string>& words) {
  const auto arguments = take_ros_arguments(words);
  if (!arguments.ok()) return arguments.status();
  ServerOptions options;
  if (Status s = apply(*arguments, options); !s.ok()) return s;
  return options;
}

TEST(RosArguments, OwnWordsStayOnBothSides) {
  const auto taken = take_ros_arguments(
      {"bpa-server", "--seed", "3", "--ros-args", "-r", "a:=b", "--", "--threads", "2"});
  ASSERT_TRUE(taken.ok());
  EXPECT_EQ(taken->own, (std::vector<std::string>{"bpa-server", "--seed", "3", "--threads", "2"}));
  EXPECT_EQ(taken->remaps, std::vector<std::string>{"a:=b"});
}

TEST(RosArguments, NamesRemapsParametersAndLevel) {
  const auto options = read({"x",
                             "--ros-args",
                             "-r",
                             "__node:=eyes",
                             "--remap",
                             "__ns:=/left",
                             "-r",
                             "detections:=/objects",
                             "-r",
                             "eyes:tf:=/tf_left",
                             "-r",
                             "other:tf:=/nowhere",
                             "-p",
                             "detection.top_k:=3",
                             "--param",
                             "use_sim_time:=true",
                             "-p",
                             "input.color:=/camera/rgb",
                             "--log-level",
                             "WARN",
                             "--disable-stdout-logs",
                             "--log-config-file",
                             "log.config",
                             "-e",
                             "/eyes"});
  ASSERT_TRUE(options.ok()) << options.status().message;
  EXPECT_EQ(options->node.name, "eyes");
  EXPECT_EQ(options->security.enclave, "/eyes");
  EXPECT_EQ(options->node.ros_namespace, "/left");
  EXPECT_EQ(options->node.remaps,
            (std::vector<std::string>{"detections:=/objects", "tf:=/tf_left"}));
  EXPECT_EQ(options->detection.top_k, 3);
  EXPECT_EQ(options->input.color, "/camera/rgb");
  EXPECT_EQ(options->log.level, "warning");
  EXPECT_TRUE(options->node.use_sim_time);
}

TEST(RosArguments, RefusesWhatItCannotDo) {
  const struct {
    std::vector<std::string> words;
    const char* reason;
  } cases[] = {{{"-r", "a=b"}, "name:=value"},
               {{"-r"}, "needs a value"},
               {{"--wrong"}, "not known"},
               {{"-p", "detection.top_k:=0"}, "between 1 and 100"},
               {{"-p", "detection.top:=1"}, "unknown key"},
               {{"--log-level", "loud"}, "log.level"},
               {{"--params-file", "nowhere.yaml"}, "no such file"},
               {{"-p", "use_sim_time:=maybe"}, "node.use_sim_time"},
               {{"--enclave"}, "needs a value"}};
  for (const auto& c : cases) {
    std::vector<std::string> words = {"x", "--ros-args"};
    words.insert(words.end(), c.words.begin(), c.words.end());
    const auto options = read(words);
    ASSERT_FALSE(options.ok()) << c.reason;
    EXPECT_NE(options.status().message.find(c.reason), std::string::npos)
        << options.status().message;
  }
}

TEST(RosArguments, ParameterFilesHaveNoAliases) {
  const test::TemporaryFolder folder;
  const std::string path = folder.path() + "/params.yaml";
  for (const char* text :
       {"a: &x\n  b: *x\n", "/**:\n  ros__parameters: &x\n    detection: *x\n"}) {
    std::ofstream(path) << text;
    const auto options = read({"x", "--ros-args", "--params-file", path});
    ASSERT_FALSE(options.ok());
    EXPECT_NE(options.status().message.find("aliases"), std::string::npos)
        << options.status().message;
  }
}

TEST(RosArguments, ParameterFilesAsLaunchWritesThem) {
  const test::TemporaryFolder folder;
  const std::string path = folder.path() + "/params.yaml";
  std::ofstream(path) << "/**:\n  ros__parameters:\n    use_sim_time: true\n"
                         "    detection: {top_k: 4, seed: 9}\n"
                         "/bpa/server:\n  ros__parameters:\n    detection.seed: 11\n"
                         "other:\n  ros__parameters:\n    detection.seed: 12\n"
                         "bpa:\n  server:\n    ros__parameters:\n      queue:\n        frames: 5\n"
                         "/elsewhere:\n  server:\n    ros__parameters: {no_such: 1}\n";
  const auto options = read({"x", "--ros-args", "--params-file", path, "-p", "queue.requests:=6"});
  ASSERT_TRUE(options.ok()) << options.status().message;
  EXPECT_TRUE(options->node.use_sim_time);
  EXPECT_EQ(options->detection.top_k, 4);
  EXPECT_EQ(options->detection.seed, 11U);
  EXPECT_EQ(options->queue.frames, 5);
  EXPECT_EQ(options->queue.requests, 6);
  std::ofstream(path) << "server:\n  ros__parameters:\n    queue:\n      frame: 5\n";
  const auto bad = read({"x", "--ros-args", "--params-file", path});
  ASSERT_FALSE(bad.ok());
  EXPECT_NE(bad.status().message.find("params.yaml:4: unknown key queue.frame"), std::string::npos)
      << bad.status().message;
}

}  // namespace
}  // namespace bpa::server
