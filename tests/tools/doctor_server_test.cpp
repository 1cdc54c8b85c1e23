// SPDX-FileCopyrightText: 2026 The bpa authors
// SPDX-License-Identifier: Apache-2.0
// A server that does well gives no finding; each trouble, told by its counters, gives its own.
#include <map>

#include <gtest/gtest.h>

#include "tools/doctor.hpp"

namespace bpa::cli {
namespace {

using Whats = std::vector<std::string>;

/// Two statuses of a server that searched 60 frames of a ROS 2 camera meanwhile.
class CheckServer : public testing::Test {
 protected:
  CheckServer() {
    before_ = {{"rejected: depth", 2},
               {"frames failed in the search", 0},
               {"ms from the last frame's stamp until it came", 40},
               {"publishers of frames", 0},
               {"messages of frames", 0},
               {"publishers of colour images", 1},
               {"publishers of depth images", 1},
               {"publishers of camera infos", 1},
               {"publishers with too weak QoS of the camera", 0},
               {"camera sets with equal stamps", 100},
               {"camera sets with near stamps", 10},
               {"depth images without a colour image", 2},
               {"depth images without a camera info", 0},
               {"ms to the nearest image that was too far", 33},
               {"messages of the camera", 330},
               {"messages malformed of the camera", 0},
               {"messages lost by DDS of the camera", 1}};
    after_ = before_;
    after_["camera sets with equal stamps"] += 60;
    after_["messages of the camera"] += 180;
  }
  /// Without frames meanwhile.
  void silence() {
    received_ = 0;
    after_ = before_;
  }
  doctor::Findings findings() const {
    ServerStatus before, after;
    before.model_count = after.model_count = models_;
    before.frames_received = 110;
    after.frames_received = 110 + received_;
    const auto fill = [](const std::map<std::string, double>& from, ServerStatus& to) {
      for (const auto& [key, value] : from) {
        to.details.emplace_back(key, std::to_string(std::lround(value)));
      }
    };
    fill(before_, before);
    fill(after_, after);
    return check_server(before, after);
  }
  Whats found() const {
    Whats out;
    for (const doctor::Finding& finding : findings()) {
      EXPECT_FALSE(finding.why.empty()) << finding.what;
      EXPECT_FALSE(finding.remedy.empty()) << finding.what;
      out.push_back(finding.what);
    }
    return out;
  }

  std::map<std::string, double> before_, after_;
  int models_ = 3;
  std::uint64_t received_ = 60;
};

TEST_F(CheckServer, SaysNothingOfOneThatDoesWell) { EXPECT_EQ(found(), Whats{}); }

TEST_F(CheckServer, WithoutModels) {
  models_ = 0;
  EXPECT_EQ(found(), Whats{"the server has no models"});
}

TEST_F(CheckServer, WithoutPublishers) {
  silence();
  for (auto& [key, value] : after_) {
    if (key.rfind("publishers", 0) == 0) value = 0;
  }
  ASSERT_EQ(found(), Whats{"the server gets no frames"});
  EXPECT_NE(findings().front().why.find("nobody"), std::string::npos);
}

TEST_F(CheckServer, WithoutOneOfTheTopics) {
  silence();
  after_["publishers of camera infos"] = 0;
  ASSERT_EQ(found(), Whats{"the server gets no frames"});
  EXPECT_NE(findings().front().why.find("camera infos"), std::string::npos);
}

TEST_F(CheckServer, WithPublishersThatSendNothing) {
  silence();
  EXPECT_EQ(found(), Whats{"the server gets no frames"});
}

TEST_F(CheckServer, WithPublishersOfOtherQos) {
  silence();
  after_["publishers with too weak QoS of the camera"] = 3;
  EXPECT_EQ(found(), Whats{"publishers and the server do not match in QoS"});
}

TEST_F(CheckServer, WithACameraOfItsOwnThatIsGone) {
  silence();
  after_["capture: sets of images"] = 7;
  EXPECT_EQ(found(), Whats{"the server's camera gives no frames"});
}

TEST_F(CheckServer, WithStampsApart) {
  after_["depth images without a colour image"] += 7;  // of 67
  ASSERT_EQ(found(), Whats{"depth images come without a colour image of their time"});
  EXPECT_NE(findings().front().why.find("33 ms"), std::string::npos);
  silence();
  after_["depth images without a camera info"] += 60;
  EXPECT_EQ(found(), Whats{"depth images come without a camera info of their time"})
      << "and not that no frame comes";
}

TEST_F(CheckServer, LosingAFewImagesIsNoMatter) {
  after_["depth images without a colour image"] += 6;  // of 66
  after_["messages lost by DDS of the camera"] += 15;  // of 195
  EXPECT_EQ(found(), Whats{});
}

TEST_F(CheckServer, LosingMessages) {
  after_["messages lost by DDS of the camera"] += 25;
  EXPECT_EQ(found(), Whats{"messages to the server are lost on the way"});
}

TEST_F(CheckServer, RefusingFrames) {
  after_["rejected: depth"] += 1;
  EXPECT_EQ(found(), Whats{"the server refuses frames: depth"});
}

TEST_F(CheckServer, FailingToSearch) {
  after_["frames failed in the search"] = 1;
  EXPECT_EQ(found(), Whats{"the server's search fails"});
}

TEST_F(CheckServer, MessagesThatCannotBeDecoded) {
  after_["messages malformed of the camera"] = 1;
  EXPECT_EQ(found(), Whats{"messages to the server cannot be decoded"});
}

TEST_F(CheckServer, ClocksApart) {
  double& age = after_["ms from the last frame's stamp until it came"];
  age = -400;
  EXPECT_EQ(found(), Whats{});
  age = -600;
  EXPECT_EQ(found(), Whats{"frames are stamped in the future"});
  age = 6000;
  EXPECT_EQ(found(), Whats{"frames are stamped long before they come"});
  received_ = 0;
  EXPECT_EQ(found(), Whats{"the server gets no frames"}) << "the last stamp is of long ago";
}

}  // namespace
}  // namespace bpa::cli
