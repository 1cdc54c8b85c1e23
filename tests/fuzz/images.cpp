// SPDX-FileCopyrightText: 2026 The bpa authors
// SPDX-License-Identifier: Apache-2.0
// PNG and JPEG, and image_transport's messages that hold them.
#include "ros/images.hpp"

#include <cstring>

#include "core/io/file_bytes.hpp"
#include "core/io/image_file.hpp"
#include "tests/fuzz/target.hpp"
#include "tests/support/depth_codecs.hpp"

namespace bpa::fuzz {
namespace {

/// Larger images are decoded in the same way, only for longer.
constexpr std::size_t kMostPixels = std::size_t{512} * 512;

std::string text_of(const std::vector<std::uint8_t>& bytes) { return {bytes.begin(), bytes.end()}; }

void check(const Result<io::ColorImage>& image) {
  if (!image.ok()) return;
  require(image->pixels.size() == std::size_t{3} * image->width * image->height,
          "a colour image has all its pixels");
}

void decode_color_file(std::string_view bytes) {
  check(io::decode_color_image(bytes, "image", kMostPixels));
}

void decode_png(std::string_view bytes) {
  decode_color_file(bytes);
  const auto depth = io::decode_depth_png(bytes, "image");
  if (depth.ok()) {
    require(depth->pixels.size() == static_cast<std::size_t>(depth->width) * depth->height,
            "a depth image has all its pixels");
  }
}

/// With the checksums that its chunks should have, which mutations do not find.
std::string with_checksums(std::string_view bytes) {
  std::string png(bytes);
  for (std::size_t at = 8; at + 12 <= png.size();) {
    std::uint32_t length = 0;
    for (std::size_t i = 0; i < 4; ++i) {
      length = length << 8 | static_cast<std::uint8_t>(png[at + i]);
    }
    if (length > png.size() - at - 12) break;
    const std::uint32_t sum = io::crc32(std::string_view(png).substr(at + 4, length + 4));
    for (std::size_t i = 0; i < 4; ++i) {
      png[at + 8 + length + i] = static_cast<char>(sum >> (24 - 8 * i));
    }
    at += 12 + length;
  }
  return png;
}

void run_png(std::string_view bytes) {
  decode_png(bytes);
  decode_png(with_checksums(bytes));
}

std::vector<std::string> png_seeds() {
  return {text_of(support::png16(support::wall_depth_mm())),
          text_of(support::compressed_color(0).data)};
}

void run_depth_file(std::string_view bytes) {
  const auto depth = io::read_depth(file_of(bytes, "depth"), 1);
  if (!depth.ok()) return;
  require(depth->metres.size() == static_cast<std::size_t>(depth->width) * depth->height,
          "a depth image has all its pixels");
}

std::vector<std::string> depth_file_seeds() {
  const std::string npy("\x93NUMPY\x01\0\x36\0", 10);
  return {npy + "{'descr': '<u2', 'fortran_order': False, 'shape': (1, 2)}abcd",
          npy + "{'descr': '>f4', 'fortran_order': False, 'shape': (1, 1)}abcd",
          "P5\n# made by hand\n2 1\n65535\nabcd"};
}

std::vector<std::string> jpeg_seeds() {
  return {text_of(support::compressed_color(0, ".jpg").data)};
}

/// A first line with the message's format, then its data.
void run_compressed(std::string_view bytes) {
  const std::size_t line = bytes.find('\n');
  if (line == std::string_view::npos) return;
  wire::sensor_msgs::CompressedImage image;
  image.format = bytes.substr(0, line);
  const std::string_view data = bytes.substr(line + 1);
  image.data.assign(data.begin(), data.end());
  const auto depth = ros::decode_depth("depth", image);
  if (!depth.ok()) return;
  require(depth->pixels.size() == std::size_t{depth->width} * depth->height,
          "a compressed depth image has all its pixels");
  for (const float z : depth->pixels) require(z >= 0, "no depth is negative");
}

std::vector<std::string> compressed_seeds() {
  std::vector<std::string> seeds;
  for (const bool rvl : {false, true}) {
    wire::sensor_msgs::CompressedImage image = support::compressed_depth(0, rvl);
    for (const std::string encoding : {"16UC1", "32FC1"}) {
      seeds.push_back(encoding + image.format.substr(5) + "\n" + text_of(image.data));
    }
  }
  seeds.push_back("16UC1; png compressed \n" + text_of(support::png16(support::wall_depth_mm())));
  return seeds;
}

/// Only the size and the checks of it; the target png decodes colours.
void run_compressed_color(std::string_view bytes) {
  wire::sensor_msgs::CompressedImage image;
  image.format = "rgb8; jpeg compressed rgb8";
  image.data.assign(bytes.begin(), bytes.end());
  if (!io::decode_color_image(bytes, "image", kMostPixels).ok()) return;
  const auto color = ros::decode_color("color", image);
  require(color.ok(), "what the core decodes, the server does");
}

}  // namespace

std::vector<Target> image_targets() {
  const char* const image_file = "core/io/image_file.cpp";
  return {{"png", image_file, run_png, png_seeds, 4096, 300},
          {"depth_file", "core/io/depth_file.cpp", run_depth_file, depth_file_seeds, 1024},
          {"jpeg", image_file, run_compressed_color, jpeg_seeds, 4096, 300},
          {"compressed_depth", "ros/compressed.cpp", run_compressed, compressed_seeds, 8192, 300}};
}

}  // namespace bpa::fuzz
