// SPDX-FileCopyrightText: 2026 The bpa authors
// SPDX-License-Identifier: Apache-2.0
#pragma once

#include <cstdint>
#include <span>
#include <string>
#include <string_view>
#include <vector>

#include "core/base/status.hpp"
#include "core/cloud/frame.hpp"

namespace bpa::io {

/// An image as files hold it: row-major, without padding.
struct ColorImage {
  int width = 0;
  int height = 0;
  std::vector<std::uint8_t> pixels;  ///< rgb, 3 bytes a pixel.
};

/// A depth or mask image; what a unit means is the owner's business.
struct GrayImage {
  int width = 0;
  int height = 0;
  std::vector<std::uint16_t> pixels;
};

/// A depth image in metres; what is not positive or not finite is no depth.
struct DepthImage {
  int width = 0;
  int height = 0;
  std::vector<float> metres;
  std::string note = {};  ///< What people should know of its unit; empty: nothing.
};

/// Images with a longer side are refused before memory is taken for their pixels.
inline constexpr int kMaxImageSide = 8192;

struct ImageSize {
  int width = 0;
  int height = 0;
  int bit_depth = 0;  ///< Bits a channel.
  int channels = 0;
};

/// Reads a PNG or JPEG of 1, 3 or 4 channels as rgb; alpha is dropped. Of 16 bits the upper 8
/// count; of grey ones, those of the largest value. All readers fail with not_found, corrupt (the
/// message names the file), invalid_argument (wrong kind of image, or too large) or unsupported
/// (another format, or a JPEG of more than 32 scans).
Result<ColorImage> read_color_image(const std::string& path);

/// Grey of cameras of 10 to 16 bits as rgb: the highest eight bits that its largest value has.
std::vector<std::uint8_t> rgb_of_grey(std::span<const std::uint16_t> grey);
/// The same of an image in memory, of at most `max_pixels`; `name` is for
/// messages.
Result<ColorImage> decode_color_image(std::string_view bytes, const std::string& name,
                                      std::size_t max_pixels);
/// Decodes a PNG in memory that must have 1 channel of 16 bits, else `unsupported`.
Result<GrayImage> decode_depth_png(std::string_view bytes, const std::string& name);
/// The depths of an image in units of `scale_mm` millimetres.
DepthImage depth_of(const GrayImage& image, double scale_mm);
/// Reads a PNG or PGM of 1 channel of 16 bits, or NumPy's npy of integers, in units of `scale_mm`;
/// or npy of floats in metres, or in millimetres where to_metres() says so. Of another file the
/// message says how to write it as one of these.
Result<DepthImage> read_depth(const std::string& path, double scale_mm);
/// Reads a 1-channel PNG of 8 or 16 bits.
Result<GrayImage> read_gray_png(const std::string& path);
/// Reads the header of a PNG only.
Result<ImageSize> read_png_size(const std::string& path);

/// Writers replace the file in one step and make missing folders. They fail with invalid_argument
/// when the pixels are not of the image's size, unavailable when the file cannot be written.
Status write_color_png(const std::string& path, const ColorImage& image);
/// 16 bits a pixel.
Status write_gray_png(const std::string& path, const GrayImage& image);
/// 8 bits a pixel.
Status write_mask_png(const std::string& path, int width, int height,
                      const std::vector<std::uint8_t>& mask);

/// The bytes that such a file has, or a JPEG of a quality of 1 to 100. Fail with invalid_argument
/// as the writers do.
Result<std::string> encode_color_png(const ColorImage& image);
Result<std::string> encode_gray_png(const GrayImage& image);
Result<std::string> encode_jpeg(const ColorImage& image, int quality);

/// The frame of a depth image and a colour image registered to it; null: none. `depth_name` stands
/// for the depth image in messages. The rest is as for read_frame().
Result<Frame> frame_of_images(DepthImage depth, const ColorImage* color, const Camera& camera,
                              const std::string& depth_name);

/// Reads one RGB-D frame: a depth image (read_depth) registered to an 8-bit colour image of its
/// size. An empty `color_path` gives no colour. A camera without a size takes the depth image's.
/// Checks sizes and camera (messages name file, field and rule); validate(Frame) checks the depths.
/// `note`: null, or set to that of the depth image.
Result<Frame> read_frame(const std::string& depth_path, const std::string& color_path,
                         const Camera& camera, double depth_scale_mm, std::string* note = nullptr);

}  // namespace bpa::io
