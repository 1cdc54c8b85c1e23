// SPDX-FileCopyrightText: 2026 The bpa authors
// SPDX-License-Identifier: Apache-2.0
#include <chrono>
#include <map>
#include <thread>

#include <gtest/gtest.h>
#include <nlohmann/json.hpp>
#include <signal.h>
#include <yaml-cpp/yaml.h>

#include "client/cli/convert.hpp"
#include "core/io/bop_dataset.hpp"
#include "core/io/mesh_file.hpp"
#include "idl/wire/publisher.hpp"
#include "ros/bag_reader.hpp"
#include "tests/support/stub_server.hpp"
#include "tests/support/temporary_folder.hpp"
#include "tests/support/wall_bag.hpp"
#include "tests/system/cli/box_scene.hpp"
#include "tests/system/cli/camera_messages.hpp"

// bpa-client record --bag as a process, beside the stub server and publishers of this process.

namespace bpa {
namespace {

using Json = nlohmann::json;
using std::chrono::milliseconds;
using std::chrono::seconds;

std::vector<std::string> record_command(const std::string& path, const std::string& topics) {
  return support::own_command("bpa-client",
                              {"--timeout", "0.5", "record", "--bag", path, "--topics", topics});
}

bool wait_for_words(const std::string& log, const std::string& words) {
  for (int i = 0; i < 750; ++i) {
    if (support::read_text(log).find(words) != std::string::npos) return true;
    std::this_thread::sleep_for(milliseconds(20));
  }
  ADD_FAILURE() << "no '" << words << "' in: " << support::read_text(log);
  return false;
}

std::string own_topic(const std::string& name) { return support::test_namespace() + "/" + name; }

template <class Message>
wire::Publisher<Message> publisher(const wire::Participant& participant, const std::string& topic,
                                   const wire::Qos& qos) {
  auto made = wire::Publisher<Message>::create(participant, topic, {qos});
  EXPECT_TRUE(made.ok()) << made.status().message;
  return std::move(made).value();
}

/// All messages by topic, as far as the recording goes.
std::map<std::string, std::vector<std::string>> messages_of(const std::string& path) {
  std::map<std::string, std::vector<std::string>> all;
  auto reader = ros::open_bag(path);
  EXPECT_TRUE(reader.ok()) << reader.status().message;
  for (auto message = (*reader)->next(); message.ok() && *message; message = (*reader)->next()) {
    all[(*message)->topic->name].emplace_back((*message)->bytes);
  }
  return all;
}

/// The message as it lies on the wire: DDS fills words of 4 bytes.
template <class Message>
std::vector<std::string> encoded(const Message& message) {
  auto bytes = wire::encode(message);
  bytes.resize((bytes.size() + 3) / 4 * 4);
  return {std::string(bytes.begin(), bytes.end())};
}

/// What a reader of MCAP and CDR that has nothing of ours finds in the file.
Json read_independently(const std::string& path) {
  const std::string out = path + ".json";
  EXPECT_EQ(
      support::run({"/usr/bin/python3", "-B", BPA_SOURCE_DIR "/tests/support/mcap_reader.py", path},
                   out),
      0)
      << support::read_text(out);
  return Json::parse(support::read_text(out), nullptr, false);
}

Json values_of(const Json& recording, const std::string& topic) {
  Json values = Json::array();
  for (const Json& message : recording.at("messages")) {
    if (message.at("topic") == topic) values.push_back(message.at("value"));
  }
  return values;
}

class RecordBag : public testing::Test {
 protected:
  Json detect(const std::string& frames) {
    const test::Outcome outcome = test::run("detect --library " + (folder_ / "L") + " " + frames +
                                            " --json " + (folder_ / "r.json"));
    EXPECT_EQ(outcome.code, 0) << outcome.out;
    const Json json = Json::parse(test::slurp(folder_ / "r.json"), nullptr, false);
    return json.at("frames").back().at("interpretations");
  }
  /// A data set of one frame, and a library of what it shows.
  Frame box_set() {
    EXPECT_TRUE(io::write_ply(folder_ / "box.ply", test::box(0.06F, 0.04F, 0.09F)).ok());
    const test::Outcome outcome = test::run("model from-mesh " + (folder_ / "box.ply") +
                                            " --name box --views 0 --library " + (folder_ / "L"));
    EXPECT_EQ(outcome.code, 0) << outcome.out;
    io::BopSceneWriter writer(folder_ / "set", "test", 0);
    EXPECT_TRUE(writer.add(0, test::box_frame(test::box_pose()), {}).ok());
    EXPECT_TRUE(writer.finish().ok());
    const auto entries = io::read_bop_frames(folder_ / "set", "test");
    return io::load_bop_frame(entries->at(0)).value();
  }

  const test::TemporaryFolder folder_;
  const std::string path_ = folder_ / "a.mcap", log_ = folder_ / "record.log";
};

FrameView view_of_frame(const Frame& frame, std::int64_t stamp_ns) {
  FrameView view = cli::view_of(frame);
  view.stamp_ns = stamp_ns;
  view.frame_id = "optical";
  return view;
}

TEST_F(RecordBag, HoldsWhatWasPublished) {
  using support::kSecond;
  const Frame frame = box_set();
  support::StubServer server({"queue.frames=20"});
  auto client = Client::connect(support::client_options());
  ASSERT_TRUE(client.ok()) << client.status().message;
  const auto participant = support::test_participant("camera");
  ASSERT_TRUE(participant.ok()) << participant.status().message;
  using wire::Reliability;
  const wire::Qos of_camera{Reliability::best_effort, wire::Durability::volatile_, 10, 0};
  auto tf = publisher<wire::tf2_msgs::TFMessage>(*participant, "tf_static", wire::qos::latched());
  auto depth = publisher<wire::sensor_msgs::Image>(*participant, "cam/depth", of_camera);
  auto color = publisher<wire::sensor_msgs::Image>(*participant, "cam/color", {});
  auto info = publisher<wire::sensor_msgs::CameraInfo>(*participant, "cam/camera_info", {});
  auto jpeg = publisher<wire::sensor_msgs::CompressedImage>(*participant, "cam/color/jpeg", {});
  auto cloud = publisher<wire::sensor_msgs::PointCloud2>(*participant, "cam/points", {});
  ASSERT_TRUE(tf.publish(support::transform()).ok());  // before anybody listens

  support::Process recorder(
      record_command(path_,
                     "frames,interpretations,detections,tf_static,cam/depth,cam/color,"
                     "cam/camera_info,cam/color/jpeg,cam/points"),
      log_);
  ASSERT_TRUE(client->publish_frame(view_of_frame(frame, 1)).ok());  // so that it is published
  for (const char* name : {"frames", "interpretations", "detections", "tf_static"}) {
    ASSERT_TRUE(wait_for_words(log_, "recording " + own_topic(name) + " ("));
  }
  for (const auto& matched :
       {color.wait_for_matched(seconds(10)), info.wait_for_matched(seconds(10)),
        depth.wait_for_matched(seconds(10)), jpeg.wait_for_matched(seconds(10)),
        cloud.wait_for_matched(seconds(10))}) {
    ASSERT_TRUE(matched) << support::read_text(log_);
  }
  std::this_thread::sleep_for(milliseconds(500));  // until it hears the server and us

  const auto& [info_message, depth_message, color_message] =
      test::CameraMessages(frame, 3 * kSecond + 7);
  wire::sensor_msgs::CompressedImage jpeg_message{depth_message.header, "rgb8; jpeg", {1, 2, 255}};
  wire::sensor_msgs::PointCloud2 cloud_message;
  cloud_message.header = depth_message.header;
  cloud_message.point_fields = {{"x", 0, 7, 1}, {"intensity", 4, 8, 1}};
  cloud_message.data = {9, 8, 7};
  EXPECT_TRUE(info.publish(info_message).ok() && depth.publish(depth_message).ok() &&
              color.publish(color_message).ok() && jpeg.publish(jpeg_message).ok() &&
              cloud.publish(cloud_message).ok());
  for (const std::int64_t stamp : {kSecond, 2 * kSecond}) {
    ASSERT_TRUE(client->publish_frame(view_of_frame(frame, stamp)).ok());
    std::this_thread::sleep_for(milliseconds(300));
  }
  std::this_thread::sleep_for(milliseconds(500));
  recorder.signal(SIGTERM);
  ASSERT_EQ(recorder.wait(seconds(10)), 0) << support::read_text(log_);

  // To the byte.
  auto messages = messages_of(path_);
  EXPECT_EQ(messages[own_topic("tf_static")], encoded(support::transform()));
  EXPECT_EQ(messages[own_topic("cam/depth")], encoded(depth_message));
  EXPECT_EQ(messages[own_topic("cam/color")], encoded(color_message));
  EXPECT_EQ(messages[own_topic("cam/camera_info")], encoded(info_message));
  EXPECT_EQ(messages[own_topic("cam/color/jpeg")], encoded(jpeg_message));
  EXPECT_EQ(messages[own_topic("cam/points")], encoded(cloud_message));

  const Json recording = read_independently(path_);
  ASSERT_TRUE(recording.is_object());
  EXPECT_EQ(recording.at("profile"), "ros2");
  const Json& topics = recording.at("topics");
  EXPECT_EQ(topics.size(), 9U);
  EXPECT_EQ(topics.at(own_topic("cam/points")).at("type"), "sensor_msgs/msg/PointCloud2");
  EXPECT_EQ(topics.at(own_topic("cam/points")).at("topic_type_hash"),
            wire::sensor_msgs::PointCloud2::kTypeHash);
  const auto qos = [&](const char* name, const char* policy) {
    const auto text = topics.at(own_topic(name)).at("offered_qos_profiles").get<std::string>();
    return YAML::Load(text)[0][policy].as<int>();
  };
  EXPECT_EQ(qos("cam/depth", "reliability"), 2);  // rmw_qos_reliability_policy_t
  EXPECT_EQ(qos("cam/color", "reliability"), 1);
  EXPECT_EQ(qos("cam/color", "durability"), 2);
  EXPECT_EQ(qos("tf_static", "durability"), 1);
  EXPECT_EQ(
      values_of(recording, own_topic("tf_static"))[0].at("transforms")[0].at("child_frame_id"),
      "wall_camera");
  const Json info_value = values_of(recording, own_topic("cam/camera_info")).at(0);
  EXPECT_EQ(info_value.at("header"),
            Json::parse(R"({"stamp": {"sec": 3, "nanosec": 7}, "frame_id": "optical"})"));
  EXPECT_EQ(info_value.at("k").get<std::vector<double>>(),
            std::vector<double>(info_message.k.begin(), info_message.k.end()));
  EXPECT_EQ(values_of(recording, own_topic("cam/depth")).at(0).at("data"), depth_message.data);
  EXPECT_EQ(values_of(recording, own_topic("cam/points")).at(0).at("fields")[1].at("name"),
            "intensity");
  const std::int64_t now_ns = std::chrono::system_clock::now().time_since_epoch().count();
  for (const Json& message : recording.at("messages")) {
    const std::int64_t sent = message.at("publish_time"), received = message.at("log_time");
    EXPECT_LE(sent, received);
    EXPECT_NEAR(static_cast<double>(sent), static_cast<double>(now_ns), 60e9);
  }
  // The stub server finds one object where the frame's centre is.
  const Json result = values_of(recording, own_topic("interpretations")).back();
  EXPECT_EQ(result.at("header").at("stamp").at("sec"), 2);
  const Json& placement = result.at("interpretations").at(0).at("placements").at(0);
  const Json detection = values_of(recording, own_topic("detections")).back().at("detections")[0];
  const Json pose = detection.at("results")[0].at("pose").at("pose");
  EXPECT_EQ(pose.at("position"), placement.at("pose").at("pose").at("position"));
  EXPECT_GT(pose.at("position").at("z"), 0.5);

  const Json of_set = detect("--bop " + (folder_ / "set"));
  ASSERT_FALSE(of_set.at(0).at("placements").empty());
  EXPECT_EQ(detect("--bag " + path_), of_set);
  EXPECT_EQ(detect("--bag " + path_ + " --depth-topic " + own_topic("cam/depth")), of_set);
}

TEST_F(RecordBag, IsReadAsFarAsItGoesWhereTheRecorderWasKilled) {
  const auto participant = support::test_participant("camera");
  ASSERT_TRUE(participant.ok()) << participant.status().message;
  auto color = publisher<wire::sensor_msgs::Image>(*participant, "color", {});
  support::Process recorder(record_command(path_, "color,nobody"), log_);
  ASSERT_TRUE(color.wait_for_matched(seconds(10))) << support::read_text(log_);
  ASSERT_TRUE(wait_for_words(log_, "not published so far: " + own_topic("nobody")));
  const auto message = support::wall_color_image(5);
  for (int i = 0; i < 40; ++i) {
    ASSERT_TRUE(color.publish(message).ok());
    std::this_thread::sleep_for(milliseconds(50));
  }
  recorder.signal(SIGKILL);
  EXPECT_EQ(recorder.wait(seconds(10)), 128 + SIGKILL);
  const auto messages = messages_of(path_)[own_topic("color")];
  EXPECT_GE(messages.size(), 10U);  // all but those of the last second
  for (const std::string& bytes : messages) EXPECT_EQ(bytes, encoded(message)[0]);
}

TEST_F(RecordBag, SaysWhatItCannotDo) {
  const auto participant = support::test_participant("camera");
  ASSERT_TRUE(participant.ok()) << participant.status().message;
  const auto odd = wire::detail::make_writer(
      *participant, {wire::dds_topic_name(own_topic("odd")), "odd::msg::dds_::Odd_", "", {}});
  ASSERT_TRUE(odd.ok()) << odd.status().message;
  {
    support::Process recorder(record_command(path_, "odd"), log_);
    ASSERT_TRUE(wait_for_words(log_, own_topic("odd") + " is not recorded: bpa has no definition"));
    recorder.signal(SIGINT);
    ASSERT_EQ(recorder.wait(seconds(10)), 0) << support::read_text(log_);
  }
  EXPECT_TRUE(messages_of(path_).empty());
  EXPECT_TRUE(read_independently(path_).at("messages").empty());

  const auto refusal = [&](const std::string& path) {
    EXPECT_EQ(support::run(record_command(path, "odd"), log_), 1);
    return support::read_text(log_);
  };
  EXPECT_EQ(refusal(path_), "bpa-client: " + path_ + ": is there already\n");
  EXPECT_EQ(refusal(folder_ / "no/a.mcap"), "bpa-client: " + (folder_ / "no/a.mcap") +
                                                " cannot be written: No such file or "
                                                "directory\n");
  // A disk that is full, as far as a process can have one to itself.
  auto color = publisher<wire::sensor_msgs::Image>(*participant, "color", {});
  std::string command = "trap '' XFSZ; ulimit -f 1; exec";
  for (const auto& word : record_command(folder_ / "b.mcap", "color")) command += " " + word;
  support::Process recorder({"/bin/sh", "-c", command}, log_);
  ASSERT_TRUE(color.wait_for_matched(seconds(10))) << support::read_text(log_);
  auto image = support::wall_color_image(5);
  for (std::size_t i = 0; i < image.data.size(); ++i) {
    image.data[i] = static_cast<std::uint8_t>(i * i * i >> 7);
  }
  for (int i = 0; i < 40; ++i) {
    ASSERT_TRUE(color.publish(image).ok());
    std::this_thread::sleep_for(milliseconds(50));
  }
  EXPECT_EQ(recorder.wait(seconds(10)), 1);
  EXPECT_NE(support::read_text(log_).find("bpa-client: " + (folder_ / "b.mcap") +
                                          " cannot be written: File too large\n"),
            std::string::npos)
      << support::read_text(log_);
}

}  // namespace
}  // namespace bpa
