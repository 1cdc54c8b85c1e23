// SPDX-FileCopyrightText: 2026 The bpa authors
// SPDX-License-Identifier: Apache-2.0
// Recordings of ROS 2 give what the same frames give as a data set.
#include <gtest/gtest.h>

#include "core/io/bop_dataset.hpp"
#include "core/io/mesh_file.hpp"
#include "core/io/results.hpp"
#include "idl/wire/cdr.hpp"
#include "idl/wire/msg/sensor_msgs.hpp"
#include "idl/wire/time.hpp"
#include "tests/support/bag_writer.hpp"
#include "tests/support/temporary_folder.hpp"
#include "tests/support/wall_messages.hpp"
#include "tests/system/cli/box_scene.hpp"
#include "tests/system/cli/camera_messages.hpp"

namespace bpa {
namespace {

template <class Message>
void record(std::vector<support::RecordedMessage>& bag, const std::string& topic,
            const Message& message) {
  const auto bytes = wire::encode(message);
  bag.push_back({topic, Message::kType, to_ns(message.header.stamp), {bytes.begin(), bytes.end()}});
}

void record(std::vector<support::RecordedMessage>& bag, const Frame& frame, std::int64_t stamp_ns) {
  const test::CameraMessages messages(frame, stamp_ns);
  record(bag, "/camera/camera_info", messages.info);
  record(bag, "/camera/depth", messages.depth);
  if (!frame.color.empty()) record(bag, "/camera/color", messages.color);
}

TEST(DetectBag, FindsWhatTheFramesShow) {
  const test::TemporaryFolder folder;
  ASSERT_TRUE(io::write_ply(folder / "box.ply", test::box(0.06F, 0.04F, 0.09F)).ok());
  const std::string library = " --library " + (folder / "L");
  test::Outcome outcome =
      test::run("model from-mesh " + (folder / "box.ply") + " --name box --views 0" + library);
  ASSERT_EQ(outcome.code, 0) << outcome.out;
  io::BopSceneWriter writer(folder / "set", "test", 0);
  ASSERT_TRUE(writer.add(0, test::box_frame(test::box_pose()), {}).ok());
  ASSERT_TRUE(writer.finish().ok());
  const auto entries = io::read_bop_frames(folder / "set", "test");
  ASSERT_TRUE(entries.ok());
  const auto frame = io::load_bop_frame(entries->front());
  ASSERT_TRUE(frame.ok());
  std::vector<support::RecordedMessage> bag;
  for (const std::int64_t second : {1, 2}) record(bag, *frame, second * 1'000'000'000);
  std::string bytes = support::mcap_of(bag, support::McapKind::zstd);
  test::spill(folder / "bag.mcap", bytes);

  const auto detect = [&](const std::string& frames) {
    outcome = test::run("detect" + library + " " + frames + " --json " + (folder / "r.json"));
    const auto results = io::read_results_json(folder / "r.json");
    EXPECT_TRUE(results.ok()) << outcome.out;
    return results.ok() ? *results : std::vector<io::FrameResult>();
  };
  const auto of_set = detect("--bop " + (folder / "set"));
  ASSERT_EQ(of_set.size(), 1U);
  const auto of_bag = detect("--bag " + (folder / "bag.mcap"));
  EXPECT_EQ(outcome.code, 0) << outcome.out;
  EXPECT_NE(outcome.out.find("depth of /camera/depth, "), std::string::npos) << outcome.out;
  ASSERT_EQ(of_bag.size(), 2U);
  EXPECT_EQ(of_bag[1].stamp_ns, 2'000'000'000);
  EXPECT_EQ(of_bag[1].im_id, 1);
  ASSERT_FALSE(of_set[0].interpretations.empty());
  const Placement& expected = of_set[0].interpretations[0].placements.at(0);
  const Placement& found = of_bag[0].interpretations.at(0).placements.at(0);
  EXPECT_EQ(found.frame_from_object.translation, expected.frame_from_object.translation);
  EXPECT_EQ(found.presence, expected.presence);

  // What is left of a recording that was cut short is searched.
  bytes.resize(bytes.size() - 200);
  test::spill(folder / "bag.mcap", bytes);
  EXPECT_EQ(detect("--bag " + (folder / "bag.mcap")).size(), 1U);
  EXPECT_EQ(outcome.code, 1);
  EXPECT_NE(outcome.out.find("is cut short, after"), std::string::npos) << outcome.out;
}

}  // namespace
}  // namespace bpa
