// SPDX-FileCopyrightText: 2026 The bpa authors
// SPDX-License-Identifier: Apache-2.0
#include "ros/frames.hpp"

#include <functional>
#include <limits>

#include <gtest/gtest.h>

#include "tests/support/wall_messages.hpp"

namespace bpa::ros {
namespace {

using wire::bpa_msgs::RgbdFrame;

TEST(FrameFromMessage, KeepsEverything) {
  RgbdFrame message = support::wall_frame(1'234'567'890'123);
  message.roi.x_offset = 4;
  message.roi.width = 20;
  message.roi.height = 48;
  message.mask.assign(support::kWidth * support::kHeight, 1);
  const auto frame = frame_from_message(message);
  ASSERT_TRUE(frame.ok()) << frame.status().message;
  EXPECT_EQ(frame->stamp_ns, 1'234'567'890'123);
  EXPECT_EQ(frame->frame_id, "wall_camera");
  EXPECT_EQ(frame->camera.width, 64);
  EXPECT_EQ(frame->camera.cy, 23.5);
  EXPECT_FLOAT_EQ(frame->depth[5], 0.71f);
  EXPECT_EQ(frame->color, support::wall_rgb());
  EXPECT_EQ(frame->roi.x, 4);
  EXPECT_EQ(frame->mask.size(), message.mask.size());
}

TEST(FrameFromMessage, NeedsNoColor) {
  RgbdFrame message = support::wall_frame();
  message.color.clear();
  message.color_encoding.clear();
  const auto frame = frame_from_message(message);
  ASSERT_TRUE(frame.ok()) << frame.status().message;
  EXPECT_TRUE(frame->color.empty());
}

struct BadFrame {
  const char* name;
  std::function<void(RgbdFrame&)> spoil;
  std::vector<const char*> words;  ///< The message must hold them: the field and the rule.
  StatusCode code = StatusCode::invalid_argument;
};

class BadFrames : public testing::TestWithParam<BadFrame> {};

TEST_P(BadFrames, AreRefusedWithFieldAndRule) {
  RgbdFrame message = support::wall_frame();
  GetParam().spoil(message);
  const auto frame = frame_from_message(message);
  ASSERT_FALSE(frame.ok());
  EXPECT_EQ(frame.status().code, GetParam().code);
  for (const char* word : GetParam().words) {
    EXPECT_NE(frame.status().message.find(word), std::string::npos) << frame.status().message;
  }
}

const BadFrame kBadFrames[] = {
    {"DepthTooShort", [](RgbdFrame& f) { f.depth.resize(100); }, {"depth", "100", "must have"}},
    {"DepthMissing", [](RgbdFrame& f) { f.depth.clear(); }, {"depth", "0", "must have"}},
    {"DepthTooLong", [](RgbdFrame& f) { f.depth.resize(99999); }, {"depth", "99999"}},
    {"ColorTooShort", [](RgbdFrame& f) { f.color.resize(7); }, {"color", "7", "must have"}},
    {"ColorEncoding",
     [](RgbdFrame& f) { f.color_encoding = "bayer"; },
     {"color", "bayer", "rgb8"},
     StatusCode::unsupported},
    {"DepthEncoding",
     [](RgbdFrame& f) { f.depth_encoding = ""; },
     {"depth", "16UC1"},
     StatusCode::unsupported},
    {"ZeroFocalLength", [](RgbdFrame& f) { f.k[0] = 0; }, {"fx", "0"}},
    {"NanPrincipalPoint", [](RgbdFrame& f) { f.k[2] = std::nan(""); }, {"cx", "nan"}},
    {"ZeroWidth", [](RgbdFrame& f) { f.width = 0; }, {"width", "0"}},
    {"HugeSize", [](RgbdFrame& f) { f.width = f.height = 4000000000U; }, {"width is 4000000000"}},
    {"AllZeroDepth", [](RgbdFrame& f) { f.depth.assign(f.depth.size(), 0); }, {"depth", "500"}},
    {"AllNanDepth",
     [](RgbdFrame& f) {
       f.depth_encoding = "32FC1";
       f.depth = support::as_bytes(std::vector<float>(f.width * f.height, std::nanf("")));
     },
     {"depth", "500"}},
    {"RoiOutside",
     [](RgbdFrame& f) {
       f.roi = {60, 0, 10, 10, false};
     },
     {"roi", "inside"}},
    {"RoiBeyondAnInt",
     [](RgbdFrame& f) { f.roi.x_offset = 4000000000U; },
     {"roi.x_offset is 4000000000", "8192"}},
    {"MaskSize", [](RgbdFrame& f) { f.mask.resize(3); }, {"mask", "3"}},
    {"ManyDistortions", [](RgbdFrame& f) { f.d.assign(14, 0.1); }, {"has 14", "8"}},
};

INSTANTIATE_TEST_SUITE_P(All, BadFrames, testing::ValuesIn(kBadFrames),
                         [](const auto& test) { return test.param.name; });

TEST(RejectionCause, NamesThePartOfTheMessage) {
  const auto cause_of = [](void (*spoil)(RgbdFrame&)) {
    RgbdFrame message = support::wall_frame();
    spoil(message);
    const DecodedFrame frame = frame_from_message(message);
    EXPECT_FALSE(frame.ok());
    return frame.cause();
  };
  EXPECT_EQ(cause_of([](RgbdFrame& f) { f.k[0] = 0; }), RejectionCause::camera);
  EXPECT_EQ(cause_of([](RgbdFrame& f) { f.d.assign(14, 0.1); }), RejectionCause::distortion);
  EXPECT_EQ(cause_of([](RgbdFrame& f) { f.depth.resize(100); }), RejectionCause::depth);
  EXPECT_EQ(cause_of([](RgbdFrame& f) { f.depth_encoding = ""; }), RejectionCause::depth);
  EXPECT_EQ(cause_of([](RgbdFrame& f) { f.color.resize(7); }), RejectionCause::color);
  EXPECT_EQ(cause_of([](RgbdFrame& f) { f.mask.resize(3); }), RejectionCause::frame);
  EXPECT_EQ(frame_from_cloud({}).cause(), RejectionCause::cloud);
  EXPECT_STREQ(kRejectionCauses[static_cast<std::size_t>(RejectionCause::frame)], "frame");
}

CameraImages wall_images() {
  return {std::make_shared<AnyImage>(support::wall_color_image(5)),
          std::make_shared<AnyImage>(support::wall_depth_image(7)),
          std::make_shared<wire::sensor_msgs::CameraInfo>(support::wall_camera_info(6))};
}

TEST(FrameFromImages, EqualsTheFrameMessage) {
  const auto frame = frame_from_images(wall_images(), false);
  const auto expected = frame_from_message(support::wall_frame());
  ASSERT_TRUE(frame.ok()) << frame.status().message;
  EXPECT_EQ(frame->stamp_ns, 7);  // the depth image's
  EXPECT_EQ(frame->depth, expected->depth);
  EXPECT_EQ(frame->color, expected->color);
  EXPECT_EQ(frame->camera.fx, 60);
}

TEST(FrameFromImages, RectifiedImagesUseTheProjectionMatrix) {
  const auto frame = frame_from_images(wall_images(), true);
  ASSERT_TRUE(frame.ok());
  EXPECT_EQ(frame->camera.fx, 58);
  EXPECT_EQ(frame->camera.cy, 23);
}

TEST(FrameFromImages, TheModelOfDistortionCounts) {
  const auto depth_of = [](const std::string& model, std::vector<double> d, bool rectified) {
    CameraImages images = wall_images();
    auto info = std::make_shared<wire::sensor_msgs::CameraInfo>(*images.info);
    info->distortion_model = model;
    info->d = std::move(d);
    images.info = info;
    const auto frame = frame_from_images(images, rectified);
    return frame.ok() ? frame->depth : std::vector<float>();
  };
  const auto plain = depth_of("plumb_bob", {}, false);
  EXPECT_EQ(depth_of("other", {0, 0, 0}, false), plain);
  EXPECT_EQ(depth_of("other", {0.1}, false), std::vector<float>());
  EXPECT_NE(depth_of("equidistant", {0.1}, false), plain);
  EXPECT_NE(depth_of("equidistant", {0.1}, false), depth_of("plumb_bob", {0.1}, false));
  EXPECT_EQ(depth_of("other", {0.1}, true), plain);  // taken out already
}

TEST(FrameFromImages, FloatsInMillimetresAreToldAndSaid) {
  CameraImages images = wall_images();
  auto depth = std::get<wire::sensor_msgs::Image>(*images.depth);
  std::vector<float> millimetres;
  for (const auto mm : support::wall_depth_mm()) millimetres.push_back(mm);
  depth.encoding = "32FC1";
  depth.step = 4 * depth.width;
  depth.data = support::as_bytes(millimetres);
  images.depth = std::make_shared<AnyImage>(depth);
  const auto frame = frame_from_images(images, false);
  ASSERT_TRUE(frame.ok()) << frame.status().message;
  const auto expected = frame_from_images(wall_images(), false);
  for (std::size_t i = 0; i < frame->depth.size(); ++i) {
    ASSERT_NEAR(frame->depth[i], expected->depth[i], 1e-6f);
  }
  EXPECT_NE(frame.note().find("taken for millimetres"), std::string::npos);
  EXPECT_TRUE(expected.note().empty());
}

TEST(NamedRectified, ByTheLastNameOfATopic) {
  for (const char* topic : {"/camera/image_rect", "image_rect_color", "rect/image_rectified"}) {
    EXPECT_TRUE(named_rectified(topic)) << topic;
  }
  for (const char* topic : {"/rect/image_raw", "/camera/direct", "image"}) {
    EXPECT_FALSE(named_rectified(topic)) << topic;
  }
}

TEST(FrameFromImages, RefusesPartsOfASensorAndWhatIsNoNumber) {
  const auto refusal = [](const std::function<void(wire::sensor_msgs::CameraInfo&)>& spoil) {
    CameraImages images = wall_images();
    wire::sensor_msgs::CameraInfo info = *images.info;
    spoil(info);
    images.info = std::make_shared<const wire::sensor_msgs::CameraInfo>(info);
    const auto frame = frame_from_images(images, false);
    return frame.ok() ? std::string() : frame.status().message;
  };
  EXPECT_EQ(refusal([](auto& info) { info.binning_x = info.binning_y = 1; }), "");
  EXPECT_EQ(refusal([](auto& info) { info.roi = {0, 0, info.height, info.width, false}; }), "");
  EXPECT_EQ(refusal([](auto& info) { info.binning_x = 2; }).rfind("camera info has binning 2x0", 0),
            0U);
  EXPECT_EQ(refusal([](auto& info) {
              info.roi = {3, 4, 20, 10, false};
            }).rfind("camera info has roi 10x20 at (3, 4)", 0),
            0U);
  EXPECT_EQ(refusal([](auto& info) {
              info.d = {0, std::numeric_limits<double>::quiet_NaN()};
            }).rfind("distortion d[1] is nan", 0),
            0U);
  EXPECT_EQ(refusal([](auto& info) { info.width = 3'000'000; }).rfind("camera width is 3000000", 0),
            0U);
}

TEST(FrameFromImages, RefusesUnregisteredDepth) {
  CameraImages images = wall_images();
  auto small = support::wall_color_image(5);
  small.width = 32;
  images.color = std::make_shared<AnyImage>(small);
  const auto frame = frame_from_images(images, false);
  EXPECT_EQ(frame.status().code, StatusCode::invalid_argument);
  EXPECT_NE(frame.status().message.find("32x48"), std::string::npos) << frame.status().message;
}

TEST(RestrictFrame, AddsRegionAndMask) {
  Frame frame = *frame_from_message(support::wall_frame());
  RgbdFrame message;
  EXPECT_TRUE(restrict_frame(message, frame).ok());
  EXPECT_TRUE(frame.roi.empty());
  message.roi = {1, 2, 30, 40, false};  // x, y, height, width
  EXPECT_TRUE(restrict_frame(message, frame).ok());
  EXPECT_EQ(frame.roi.width, 40);
  message.mask.resize(5);
  EXPECT_FALSE(restrict_frame(message, frame).ok());
}

TEST(RestrictFrame, RefusesPriorsInAnotherFrame) {
  Frame frame = *frame_from_message(support::wall_frame());
  RgbdFrame message;
  message.priors.resize(1);
  EXPECT_TRUE(restrict_frame(message, frame).ok());
  message.header.frame_id = "wall_camera";
  EXPECT_TRUE(restrict_frame(message, frame).ok());
  message.header.frame_id = "map";
  const Status status = restrict_frame(message, frame);
  EXPECT_EQ(status.code, StatusCode::invalid_argument);
  EXPECT_EQ(status.message,
            "header.frame_id is \"map\", which priors are in; it must be empty or that of the "
            "camera, \"wall_camera\"");
}

}  // namespace
}  // namespace bpa::ros
