// SPDX-FileCopyrightText: 2026 The bpa authors
// SPDX-License-Identifier: Apache-2.0
#include <filesystem>
#include <functional>

#include <gtest/gtest.h>

#include "ros/bag_frames.hpp"
#include "tests/support/temporary_folder.hpp"
#include "tests/support/wall_bag.hpp"

namespace bpa::ros {
namespace {

using support::kSecond;
using support::McapKind;
using support::recorded;
using support::RecordedMessage;
using support::recording;
using support::transform;
using test::TemporaryFolder;

std::string mcap(const TemporaryFolder& folder, const std::vector<RecordedMessage>& messages,
                 McapKind kind = McapKind::zstd) {
  test::spill(folder / "bag.mcap", support::mcap_of(messages, kind));
  return folder / "bag.mcap";
}

/// Stamps of the frames, each of which shows the wall.
std::vector<std::int64_t> stamps_of(BagFrames& bag) {
  std::vector<std::int64_t> stamps;
  for (auto frame = bag.next(); frame.ok() && *frame; frame = bag.next()) {
    EXPECT_TRUE((*frame)->ok()) << (*frame)->status().message;
    if (!(*frame)->ok()) break;
    EXPECT_EQ((**frame)->color, support::wall_rgb());
    EXPECT_FLOAT_EQ((**frame)->depth[5], 0.71F);
    EXPECT_EQ((**frame)->camera.fx, 60);
    stamps.push_back((**frame)->stamp_ns);
  }
  return stamps;
}

using Write = std::function<std::string(const TemporaryFolder&)>;

class BagKinds : public testing::TestWithParam<std::pair<const char*, Write>> {};

TEST_P(BagKinds, GiveTheFramesThatWereRecorded) {
  const TemporaryFolder folder;
  int transforms = 0;
  auto bag =
      BagFrames::open(GetParam().second(folder), {}, 0, [&](const auto& message, bool is_static) {
        EXPECT_EQ(message.transforms[0].child_frame_id, "wall_camera");
        transforms += is_static ? 1 : 100;
      });
  ASSERT_TRUE(bag.ok()) << bag.status().message;
  EXPECT_EQ(stamps_of(*bag), std::vector<std::int64_t>({kSecond, 2 * kSecond, 3 * kSecond}));
  EXPECT_EQ(transforms, 1);
}

Write mcap_writer(McapKind kind) {
  return [kind](const TemporaryFolder& folder) { return mcap(folder, recording(), kind); };
}

std::string database(const TemporaryFolder& folder) {
  support::write_db3(folder / "bag.db3", recording());
  return folder / "bag.db3";
}

/// Two files, of which the second has the last frame.
std::string split(const TemporaryFolder& folder) {
  auto first = recording();
  const std::vector<RecordedMessage> last(first.end() - 3, first.end());
  first.resize(first.size() - 3);
  test::spill(folder / "a.mcap", support::mcap_of(first, McapKind::plain));
  test::spill(folder / "b.mcap", support::mcap_of(last, McapKind::lz4));
  test::spill(folder / "metadata.yaml",
              "rosbag2_bagfile_information:\n  relative_file_paths: [a.mcap, b.mcap]\n");
  return folder.path();
}

std::string compressed_messages(const TemporaryFolder& folder) {
  support::write_db3(folder / "bag_0.db3", recording(), true);
  test::spill(
      folder / "metadata.yaml",
      "rosbag2_bagfile_information:\n  compression_format: zstd\n  compression_mode: MESSAGE\n"
      "  relative_file_paths:\n    - bag_0.db3\n");
  return folder.path();
}

std::string without_metadata(const TemporaryFolder& folder) {
  database(folder);
  return folder.path();
}

INSTANTIATE_TEST_SUITE_P(
    Kinds, BagKinds,
    testing::Values(std::pair("NoChunks", mcap_writer(McapKind::no_chunks)),
                    std::pair("Plain", mcap_writer(McapKind::plain)),
                    std::pair("Lz4", mcap_writer(McapKind::lz4)),
                    std::pair("Zstd", mcap_writer(McapKind::zstd)),
                    std::pair("Sqlite", Write(database)), std::pair("Split", Write(split)),
                    std::pair("CompressedMessages", Write(compressed_messages)),
                    std::pair("WithoutMetadata", Write(without_metadata))),
    [](const auto& test) { return test.param.first; });

TEST(BagFrames, BeginLater) {
  const TemporaryFolder folder;
  auto bag = BagFrames::open(mcap(folder, recording()), {}, 1.5);
  ASSERT_TRUE(bag.ok());
  EXPECT_EQ(stamps_of(*bag), std::vector<std::int64_t>{3 * kSecond});
}

TEST(BagFrames, AreOfRegisteredDepthAndItsColor) {
  auto messages = recording();
  for (int i = 1; i <= 3; ++i) {  // the depth camera's own images, and infrared of another frame
    auto depth = support::wall_depth_image(i * kSecond);
    depth.header.frame_id = "depth_camera";
    messages.push_back(recorded("/camera/depth/raw", i * kSecond, depth));
    auto infrared = support::wall_color_image(i * kSecond);
    infrared.header.frame_id = "infrared_camera";
    messages.push_back(recorded("/camera/infrared", i * kSecond, infrared));
  }
  const TemporaryFolder folder;
  auto bag = BagFrames::open(mcap(folder, messages), {});
  ASSERT_TRUE(bag.ok()) << bag.status().message;
  EXPECT_EQ(bag->description(),
            "depth of /camera/depth, colour of /camera/color, camera of /camera/camera_info");
}

TEST(BagFrames, OfTwoCamerasOneIsNamed) {
  auto messages = recording();
  for (const RecordedMessage& message : recording(3, "/other")) messages.push_back(message);
  const TemporaryFolder folder;
  const std::string path = mcap(folder, messages);
  const auto bag = BagFrames::open(path, {});
  ASSERT_FALSE(bag.ok());
  EXPECT_NE(bag.status().message.find("depth images: /camera/depth, /other/depth; name"),
            std::string::npos)
      << bag.status().message;
  BagTopics topics;
  topics.depth = "/other/depth";
  topics.color = "/other/color";
  auto named = BagFrames::open(path, topics);
  ASSERT_TRUE(named.ok()) << named.status().message;
  EXPECT_EQ(named->description(),
            "depth of /other/depth, colour of /other/color, camera of /other/camera_info");
}

TEST(BagFrames, AreWholeFramesOfClients) {
  const TemporaryFolder folder;
  const std::string path =
      mcap(folder, {recorded("/bpa/frames", kSecond, support::wall_frame(kSecond))}, McapKind::lz4);
  auto bag = BagFrames::open(path, {});
  ASSERT_TRUE(bag.ok()) << bag.status().message;
  EXPECT_EQ(stamps_of(*bag), std::vector<std::int64_t>{kSecond});
}

TEST(BagFrames, OneBadMessageEndsNothing) {
  auto messages = recording();
  auto bad = support::wall_frame(0);
  messages.clear();
  messages.push_back(recorded("/frames", 1, support::wall_frame(1)));
  bad.depth.clear();
  messages.push_back(recorded("/frames", 2, bad));
  messages.push_back(recorded("/frames", 3, support::wall_frame(3)));
  messages[1].cdr.resize(20);
  messages.insert(messages.begin() + 2, recorded("/frames", 2, bad));
  const TemporaryFolder folder;
  auto bag = BagFrames::open(mcap(folder, messages), {});
  ASSERT_TRUE(bag.ok());
  std::string seen;
  for (auto frame = bag->next(); *frame; frame = bag->next()) seen += (*frame)->ok() ? 'g' : 'b';
  EXPECT_EQ(seen, "gbbg");
}

struct BadBag {
  const char* name;
  std::function<std::string(const TemporaryFolder&)> write;
  const char* words;
};

class BadBags : public testing::TestWithParam<BadBag> {};

TEST_P(BadBags, AreRefusedWithTheReason) {
  const TemporaryFolder folder;
  auto bag = BagFrames::open(GetParam().write(folder), {});
  Status status = bag.status();
  while (status.ok()) {
    const auto frame = bag->next();
    ASSERT_TRUE(!frame.ok() || *frame) << "the end came without a word";
    status = frame.status();
  }
  EXPECT_NE(status.message.find(GetParam().words), std::string::npos) << status.message;
}

std::string changed(const TemporaryFolder& folder, McapKind kind,
                    const std::function<void(std::string&)>& change) {
  std::string bytes = support::mcap_of(recording(), kind);
  change(bytes);
  test::spill(folder / "bag.mcap", bytes);
  return folder / "bag.mcap";
}

INSTANTIATE_TEST_SUITE_P(
    Kinds, BadBags,
    testing::Values(
        BadBag{"CutShort",
               [](const auto& folder) {
                 return changed(folder, McapKind::lz4,
                                [](auto& bytes) { bytes.resize(bytes.size() - 300); });
               },
               "is cut short, after"},
        BadBag{"ChangedChunk",
               [](const auto& folder) {
                 return changed(folder, McapKind::plain,
                                [](auto& bytes) { bytes[bytes.size() / 2] ^= 1; });
               },
               "a chunk is damaged"},
        BadBag{"Ros1Messages",
               [](const auto& folder) {
                 test::spill(folder / "bag.mcap",
                             support::mcap_of(recording(), McapKind::zstd, "ros1"));
                 return folder / "bag.mcap";
               },
               "rosbags-convert"},
        BadBag{"NoMcap",
               [](const auto& folder) {
                 test::spill(folder / "bag.mcap", "nothing");
                 return folder / "bag.mcap";
               },
               "is no MCAP file"},
        BadBag{"OtherDatabase",
               [](const auto& folder) {
                 test::spill(folder / "bag.db3", "");
                 return folder / "bag.db3";
               },
               "no such table"},
        BadBag{"WholeFileCompressed", [](const auto& folder) { return folder / "bag.db3.zstd"; },
               "unzstd"},
        BadBag{"Ros1", [](const auto& folder) { return folder / "camera.bag"; }, "rosbags-convert"},
        BadBag{"Missing", [](const auto& folder) { return folder / "bag.mcap"; },
               "cannot be opened"},
        BadBag{"Empty", [](const auto& folder) { return folder.path(); }, "holds no .mcap"},
        BadBag{"NoCamera",
               [](const auto& folder) {
                 return mcap(folder, {recorded("/tf_static", kSecond, transform())});
               },
               "Its topics: /tf_static (tf2_msgs/msg/TFMessage)"},
        BadBag{"NoColorInTime",
               [](const auto& folder) {
                 auto messages = recording(1);
                 messages[2] =
                     recorded("/camera/color", kSecond, support::wall_color_image(2 * kSecond));
                 messages.push_back(recorded("/camera/color", 3 * kSecond,
                                             support::wall_color_image(3 * kSecond)));
                 return mcap(folder, messages);
               },
               "without a colour image"}),
    [](const auto& test) { return test.param.name; });

}  // namespace
}  // namespace bpa::ros
