// SPDX-FileCopyrightText: 2026 The bpa authors
// SPDX-License-Identifier: Apache-2.0
#include "ros/images.hpp"

#include <cmath>
#include <cstring>
#include <limits>

#include <gtest/gtest.h>

namespace bpa::ros {
namespace {

template <class T>
std::vector<std::uint8_t> bytes_of(const std::vector<T>& values) {
  std::vector<std::uint8_t> bytes(values.size() * sizeof(T));
  std::memcpy(bytes.data(), values.data(), bytes.size());
  return bytes;
}

ImageView view(const char* encoding, std::uint32_t width, std::uint32_t height,
               const std::vector<std::uint8_t>& bytes) {
  return {"depth", encoding, width, height, 0, false, bytes.data(), bytes.size()};
}

TEST(Depth, MillimetresAndMetresAgree) {
  const auto mm = bytes_of<std::uint16_t>({0, 1, 500, 65535});
  const auto metres = bytes_of<float>({0.0f, 0.001f, 0.5f, 65.535f});
  const auto from_mm = depth_from_image(view("16UC1", 2, 2, mm));
  const auto from_m = depth_from_image(view("32FC1", 2, 2, metres));
  ASSERT_TRUE(from_mm.ok() && from_m.ok());
  for (std::size_t i = 0; i < 4; ++i) EXPECT_NEAR((*from_mm)[i], (*from_m)[i], 1e-5);
}

TEST(Depth, InvalidMetresBecomeZero) {
  const float inf = std::numeric_limits<float>::infinity();
  const auto depth = depth_from_image(view("32FC1", 4, 1, bytes_of<float>({NAN, inf, -inf, -1})));
  ASSERT_TRUE(depth.ok());
  for (const float z : *depth) EXPECT_EQ(z, 0.0f);
}

TEST(Depth, HonoursByteOrderAndStep) {
  // Two rows of one pixel, each followed by two bytes of padding.
  const std::vector<std::uint8_t> big = {0x01, 0x02, 0xff, 0xff, 0x03, 0x04, 0xff, 0xff};
  ImageView image = view("16UC1", 1, 2, big);
  image.step = 4;
  image.big_endian = true;
  const auto depth = depth_from_image(image);
  ASSERT_TRUE(depth.ok()) << depth.status().message;
  EXPECT_FLOAT_EQ((*depth)[0], 0.001f * 0x0102);
  EXPECT_FLOAT_EQ((*depth)[1], 0.001f * 0x0304);
}

TEST(Depth, RefusesWhatItCannotRead) {
  const std::vector<std::uint8_t> bytes(8);
  const auto size = depth_from_image(view("16UC1", 2, 3, bytes));
  EXPECT_EQ(size.status().code, StatusCode::invalid_argument);
  EXPECT_NE(size.status().message.find("depth data has 8 bytes; it must have 12"),
            std::string::npos)
      << size.status().message;
  ImageView narrow = view("16UC1", 2, 2, bytes);
  narrow.step = 3;
  EXPECT_NE(depth_from_image(narrow).status().message.find("step is 3; it must be at least 4"),
            std::string::npos);
  EXPECT_EQ(depth_from_image(view("8UC1", 2, 4, bytes)).status().code, StatusCode::unsupported);
  const std::uint32_t huge = 4000000000U;  // huge * huge * 2 overflows
  EXPECT_EQ(depth_from_image(view("16UC1", huge, huge, bytes)).status().code,
            StatusCode::invalid_argument);
  EXPECT_EQ(depth_from_image(view("16UC1", 0, 2, bytes)).status().code,
            StatusCode::invalid_argument);
}

struct ColorCase {
  const char* encoding;
  std::vector<std::uint8_t> pixel;  ///< Of red 1, green 2, blue 3 (or grey 7).
  std::vector<std::uint8_t> rgb;
};

class Color : public testing::TestWithParam<ColorCase> {};

TEST_P(Color, BecomesRgb) {
  const ColorCase& c = GetParam();
  std::vector<std::uint8_t> bytes = c.pixel;
  bytes.insert(bytes.end(), c.pixel.begin(), c.pixel.end());
  const auto rgb = color_from_image(view(c.encoding, 2, 1, bytes));
  ASSERT_TRUE(rgb.ok()) << rgb.status().message;
  std::vector<std::uint8_t> expected = c.rgb;
  expected.insert(expected.end(), c.rgb.begin(), c.rgb.end());
  EXPECT_EQ(*rgb, expected);
}

INSTANTIATE_TEST_SUITE_P(Encodings, Color,
                         testing::Values(ColorCase{"rgb8", {1, 2, 3}, {1, 2, 3}},
                                         ColorCase{"bgr8", {3, 2, 1}, {1, 2, 3}},
                                         ColorCase{"rgba8", {1, 2, 3, 9}, {1, 2, 3}},
                                         ColorCase{"bgra8", {3, 2, 1, 9}, {1, 2, 3}},
                                         ColorCase{"mono8", {7}, {7, 7, 7}},
                                         ColorCase{"mono16", {200, 7}, {249, 249, 249}}),
                         [](const auto& test) { return test.param.encoding; });

/// Cameras have 10 to 16 bits, and say so nowhere.
TEST(Mono16, HasTheHighestEightBitsThatAreUsed) {
  const auto greys = [](std::vector<std::uint16_t> values, bool big_endian) {
    std::vector<std::uint8_t> bytes;
    for (const std::uint16_t value : values) {
      bytes.push_back(static_cast<std::uint8_t>(big_endian ? value >> 8 : value));
      bytes.push_back(static_cast<std::uint8_t>(big_endian ? value : value >> 8));
    }
    ImageView image = view("mono16", static_cast<int>(values.size()), 1, bytes);
    image.big_endian = big_endian;
    const auto rgb = color_from_image(image);
    EXPECT_TRUE(rgb.ok());
    std::vector<int> out;
    for (std::size_t i = 0; rgb.ok() && i < rgb->size(); i += 3) out.push_back((*rgb)[i]);
    return out;
  };
  EXPECT_EQ(greys({0, 4, 512, 1020}, false), (std::vector<int>{0, 1, 128, 255}));
  EXPECT_EQ(greys({0, 4, 512, 1020}, true), (std::vector<int>{0, 1, 128, 255}));
  EXPECT_EQ(greys({256, 32768, 65280}, false), (std::vector<int>{1, 128, 255}));
  EXPECT_EQ(greys({0, 9, 255}, false), (std::vector<int>{0, 9, 255}));
}

TEST(ColorErrors, NamesTheEncodingsItKnows) {
  const std::vector<std::uint8_t> bytes(6);
  const auto rgb = color_from_image(view("yuv422", 2, 1, bytes));
  EXPECT_EQ(rgb.status().code, StatusCode::unsupported);
  EXPECT_NE(rgb.status().message.find("rgb8, bgr8"), std::string::npos);
}

}  // namespace
}  // namespace bpa::ros
