// SPDX-FileCopyrightText: 2026 The bpa authors
// SPDX-License-Identifier: Apache-2.0
#include <algorithm>
#include <cmath>

#include <gtest/gtest.h>

#include "core/io/file_bytes.hpp"
#include "ros/frames.hpp"
#include "ros/images.hpp"
#include "tests/support/depth_codecs.hpp"

namespace bpa::ros {
namespace {

using support::kHeight;
using support::kWidth;
using wire::sensor_msgs::CompressedImage;

std::vector<float> wall_metres() {
  std::vector<float> metres;
  for (const std::uint16_t mm : support::wall_depth_mm()) {
    metres.push_back(static_cast<float>(mm * 0.001));
  }
  return metres;
}

TEST(Rvl, GivesBackWhatTheEncoderTook) {
  const std::vector<std::vector<std::uint16_t>> images = {
      {0}, {5}, {0, 0, 0}, {65535, 1, 65535}, {0, 1, 0, 0, 2, 3, 0}, support::wall_depth_mm()};
  for (const auto& image : images) {
    const auto stream = support::RvlEncoder::encode(image);
    std::vector<std::uint16_t> back;
    ASSERT_TRUE(decode_rvl(stream.data(), stream.size(), image.size(), back));
    EXPECT_EQ(back, image);
  }
}

TEST(Rvl, RefusesStreamsThatDoNotFit) {
  const std::vector<std::uint16_t> image = support::wall_depth_mm();
  const auto stream = support::RvlEncoder::encode(image);
  std::vector<std::uint16_t> back;
  for (std::size_t size = 0; size + 4 < stream.size(); size += 97) {
    EXPECT_FALSE(decode_rvl(stream.data(), size, image.size(), back)) << size;
  }
  EXPECT_FALSE(decode_rvl(stream.data(), stream.size(), 10, back));
  const std::vector<std::uint8_t> endless(64, 0xff), empty(64, 0x00);
  EXPECT_FALSE(decode_rvl(endless.data(), endless.size(), 100, back));
  EXPECT_FALSE(decode_rvl(empty.data(), empty.size(), 100, back));
}

TEST(DecodeColor, LosslessFilesInEitherOrderOfChannels) {
  CompressedImage image = support::compressed_color(1);
  auto decoded = decode_color("color", image);
  ASSERT_TRUE(decoded.ok()) << decoded.status().message;
  EXPECT_EQ(decoded->width, kWidth);
  EXPECT_EQ(decoded->pixels, support::wall_rgb());
  image.format = "png";  // writers that say nothing more store blue first, as OpenCV does
  EXPECT_EQ(decode_color("color", image)->pixels, support::wall_rgb());
  image.format = "rgb8; png compressed rgb8";  // red was written where a reader expects blue
  decoded = decode_color("color", image);
  EXPECT_EQ(decoded->pixels[0], support::wall_rgb()[2]);
  EXPECT_EQ(decoded->pixels[2], support::wall_rgb()[0]);
}

TEST(DecodeColor, JpegHasItsSizeAndNearlyItsColours) {
  CompressedImage image;
  image.format = "bgr8; jpeg compressed bgr8";
  cv::imencode(".jpg", cv::Mat(48, 64, CV_8UC3, cv::Scalar(30, 60, 200)), image.data);
  const auto decoded = decode_color("color", image);
  ASSERT_TRUE(decoded.ok()) << decoded.status().message;
  EXPECT_EQ(decoded->height, 48U);
  EXPECT_NEAR(decoded->pixels[0], 200, 3);
  EXPECT_NEAR(decoded->pixels[1], 60, 3);
  EXPECT_NEAR(decoded->pixels[2], 30, 3);
}

TEST(DecodeDepth, MillimetresOfEveryPlugin) {
  for (const bool rvl : {false, true}) {
    const auto decoded = decode_depth("depth", support::compressed_depth(1, rvl));
    ASSERT_TRUE(decoded.ok()) << decoded.status().message;
    EXPECT_EQ(decoded->width, kWidth);
    EXPECT_EQ(decoded->height, kHeight);
    EXPECT_EQ(decoded->pixels, wall_metres());
  }
  CompressedImage plain;
  plain.format = "16UC1; png compressed ";
  plain.data = support::png16(support::wall_depth_mm());
  EXPECT_EQ(decode_depth("depth", plain)->pixels, wall_metres());
}

TEST(DecodeDepth, InverseDepthOfFloats) {
  // As the plugin quantises: v = a / z + b.
  constexpr float kA = 10000, kB = 100;
  std::vector<std::uint16_t> values;
  std::vector<float> metres;
  for (const std::uint16_t mm : support::wall_depth_mm()) {
    const auto v = static_cast<std::uint16_t>(kA / (static_cast<float>(mm) * 1e-3f) + kB);
    values.push_back(v);
    metres.push_back(kA / (static_cast<float>(v) - kB));
  }
  values[0] = 0;    // no depth
  values[1] = 100;  // infinitely far
  values[2] = 50;   // nonsense
  metres[0] = metres[1] = metres[2] = 0;
  CompressedImage image;
  image.format = "32FC1; compressedDepth png";
  image.data = support::depth_header(kA, kB);
  const auto file = support::png16(values);
  image.data.insert(image.data.end(), file.begin(), file.end());
  const auto decoded = decode_depth("depth", image);
  ASSERT_TRUE(decoded.ok()) << decoded.status().message;
  EXPECT_EQ(decoded->pixels, metres);
}

TEST(DecodeDepth, RefusesWhatIsNoDepth) {
  const auto refused = [](CompressedImage image, StatusCode code) {
    const auto decoded = decode_depth("depth", image);
    EXPECT_EQ(decoded.status().code, code) << decoded.status().message;
    EXPECT_EQ(decoded.status().message.rfind("depth ", 0), 0U) << decoded.status().message;
  };
  CompressedImage image = support::compressed_color(1);
  refused(image, StatusCode::unsupported);  // format rgb8
  image.format = "16UC1; png compressed ";
  refused(image, StatusCode::unsupported);  // 8 bits, three channels
  image = support::compressed_depth(1, false);
  image.data.resize(8);
  refused(image, StatusCode::corrupt);
  image = support::compressed_depth(1, false);
  image.data.resize(image.data.size() / 2);
  refused(image, StatusCode::corrupt);
  image = support::compressed_depth(1, false);
  image.data[12 + 16] = 0x7f;  // the file says that it is 2 billion pixels wide
  refused(image, StatusCode::invalid_argument);
  image = support::compressed_depth(1, true);
  image.data[12 + 3] = 0x7f;
  refused(image, StatusCode::invalid_argument);
  image = support::compressed_depth(1, true);
  image.data.resize(40);
  refused(image, StatusCode::corrupt);
  image.data.assign(100, 7);
  image.format = "16UC1; compressedDepth png";
  refused(image, StatusCode::unsupported);
}

/// A file whose frame header says 9000 x 64, with something in front of that header.
std::vector<std::uint8_t> jpeg_bomb(const std::vector<std::uint8_t>& before_frame) {
  std::vector<std::uint8_t> file;
  cv::imencode(".jpg", cv::Mat(64, 9000, CV_8UC3, cv::Scalar(30, 60, 200)), file);
  const std::uint8_t frame[] = {0xff, 0xc0};
  const auto at = std::search(file.begin(), file.end(), std::begin(frame), std::end(frame));
  file.insert(at, before_frame.begin(), before_frame.end());
  return file;
}

TEST(DecodeColor, SizesOfJpegFilesAreThoseThatTheDecoderSees) {
  // Each makes the size that follows the 0xc0 look like 16 x 16 where it is not understood.
  const std::vector<std::vector<std::uint8_t>> cases = {
      {0xff},                                                      // fill byte
      {0xff, 0xd0, 0, 2, 0xff, 0xc0, 0, 17, 8, 0, 16, 0, 16, 3},   // restart
      {0xff, 0x01, 0, 2, 0xff, 0xc0, 0, 17, 8, 0, 16, 0, 16, 3},   // temporary
      {0, 0xff, 0xc0, 0, 17, 8, 0, 16, 0, 16, 3},                  // garbage
      {0xff, 0xfe, 0, 1, 0xff, 0xc0, 0, 17, 8, 0, 16, 0, 16, 3},   // short comment
      {0xff, 0xfe, 0, 12, 0xff, 0xc0, 0, 17, 8, 0, 16, 0, 16, 3},  // comment
  };
  for (std::size_t i = 0; i < cases.size(); ++i) {
    CompressedImage image;
    image.format = "bgr8; jpeg compressed bgr8";
    image.data = jpeg_bomb(cases[i]);
    const auto decoded = decode_color("color", image);
    ASSERT_FALSE(decoded.ok()) << i;
    const bool understood = i == 0 || i == 5;
    EXPECT_EQ(decoded.status().code,
              understood ? StatusCode::invalid_argument : StatusCode::corrupt)
        << i << ": " << decoded.status().message;
  }
}

TEST(DecodeColor, ManyScansAreRefused) {
  CompressedImage image;
  cv::imencode(".jpg", cv::Mat(48, 64, CV_8UC3, cv::Scalar(30, 60, 200)), image.data,
               {cv::IMWRITE_JPEG_PROGRESSIVE, 1});
  ASSERT_TRUE(decode_color("color", image).ok());
  const std::uint8_t scan[] = {0xff, 0xda};
  const auto last =
      std::find_end(image.data.begin(), image.data.end(), std::begin(scan), std::end(scan));
  const std::vector<std::uint8_t> again(last, image.data.end() - 2);
  for (int i = 0; i < 100; ++i) {
    image.data.insert(image.data.end() - 2, again.begin(), again.end());
  }
  EXPECT_EQ(decode_color("color", image).status().code, StatusCode::unsupported);
}

TEST(DecodeDepth, APngBeginsWithItsHeader) {
  // The first chunk says 16 x 16 where readers look for the header; the real one says 9000 x 64.
  cv::Mat large(64, 9000, CV_16UC1, cv::Scalar(1000));
  CompressedImage image;
  image.format = "16UC1; png compressed ";
  cv::imencode(".png", large, image.data);
  const std::string content = std::string("teXt\0\0\0\x10\0\0\0\x10\x10\0\0\0\0", 17);
  const std::uint32_t sum = io::crc32(content);
  std::vector<std::uint8_t> chunk = {0, 0, 0, 13};
  chunk.insert(chunk.end(), content.begin(), content.end());
  for (int shift = 24; shift >= 0; shift -= 8) {
    chunk.push_back(static_cast<std::uint8_t>(sum >> static_cast<unsigned>(shift)));
  }
  image.data.insert(image.data.begin() + 8, chunk.begin(), chunk.end());
  EXPECT_EQ(decode_depth("depth", image).status().code, StatusCode::corrupt);
}

TEST(FrameFromCompressedImages, CompressedImagesGiveTheFrameOfRawOnes) {
  CameraImages images{
      std::make_shared<AnyImage>(support::compressed_color(5)),
      std::make_shared<AnyImage>(support::compressed_depth(7, true)),
      std::make_shared<wire::sensor_msgs::CameraInfo>(support::wall_camera_info(6))};
  const auto frame = frame_from_images(images, false);
  const auto expected = frame_from_message(support::wall_frame());
  ASSERT_TRUE(frame.ok()) << frame.status().message;
  EXPECT_EQ(frame->stamp_ns, 7);
  EXPECT_EQ(frame->depth, expected->depth);
  EXPECT_EQ(frame->color, expected->color);
  auto other = support::wall_camera_info(6);
  other.width = 32;
  images.info = std::make_shared<wire::sensor_msgs::CameraInfo>(other);
  EXPECT_NE(frame_from_images(images, false).status().message.find("registered"),
            std::string::npos);
}

}  // namespace
}  // namespace bpa::ros
