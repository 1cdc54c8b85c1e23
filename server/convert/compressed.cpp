// SPDX-FileCopyrightText: 2026 The bpa authors
// SPDX-License-Identifier: Apache-2.0
#include <cmath>
#include <cstring>
#include <exception>
#include <string>
#include <string_view>

#include <opencv2/imgcodecs.hpp>

#include "core/base/concat.hpp"
#include "server/convert/images.hpp"

namespace bpa::server {
namespace {

using wire::ByteView;
using wire::sensor_msgs::CompressedImage;

constexpr std::size_t kDepthHeader = 12;

struct Size {
  std::uint32_t width = 0, height = 0;
};

std::uint32_t big_endian(const std::uint8_t* bytes, int count) {
  std::uint32_t value = 0;
  for (int i = 0; i < count; ++i) value = value << 8U | bytes[i];
  return value;
}

bool is_png(ByteView file) {
  return file.size >= 24 && std::memcmp(file.data, "\x89PNG\r\n\x1a\n", 8) == 0;
}

/// The size that the frame header of a JPEG file gives; zero when there is none.
Size jpeg_size(ByteView file) {
  std::size_t at = 2;
  while (at + 9 <= file.size && file.data[at] == 0xff) {
    const std::uint8_t marker = file.data[at + 1];
    const bool frame =
        marker >= 0xc0 && marker <= 0xcf && marker != 0xc4 && marker != 0xc8 && marker != 0xcc;
    if (frame) return {big_endian(file.data + at + 7, 2), big_endian(file.data + at + 5, 2)};
    at += 2 + big_endian(file.data + at + 2, 2);
  }
  return {};
}

/// The size of a PNG or JPEG file, from its first bytes.
Result<Size> size_of(const char* field, ByteView file) {
  Size size;
  if (is_png(file)) {
    size = {big_endian(file.data + 16, 4), big_endian(file.data + 20, 4)};
  } else if (file.size >= 4 && file.data[0] == 0xff && file.data[1] == 0xd8) {
    size = jpeg_size(file);
  } else {
    return Status(StatusCode::unsupported, concat(field, " data is neither a PNG nor a JPEG file"));
  }
  const Status status = check_size(std::string(field) + " image", size.width, size.height);
  if (!status.ok()) return status;
  return size;
}

Result<cv::Mat> decode_file(const char* field, ByteView file, int mode) {
  const Result<Size> size = size_of(field, file);
  if (!size.ok()) return size.status();
  cv::Mat pixels;
  try {
    // Wrapped, not copied: imdecode only reads.
    const cv::Mat wrapped(1, static_cast<int>(file.size), CV_8UC1,
                          const_cast<std::uint8_t*>(file.data));
    pixels = cv::imdecode(wrapped, mode);
  } catch (const std::exception&) {
    pixels.release();
  }
  if (pixels.empty()) {
    return corrupt(field, " data is a damaged image file");
  }
  return pixels;
}

Result<Decoded<std::uint16_t>> decode_png16(const char* field, ByteView file) {
  const Result<cv::Mat> pixels = decode_file(field, file, cv::IMREAD_UNCHANGED);
  if (!pixels.ok()) return pixels.status();
  if (pixels->type() != CV_16UC1) {
    return Status(
        StatusCode::unsupported,
        concat(field, " data is no PNG of 16 bits and one channel, so it holds no depth"));
  }
  return Decoded<std::uint16_t>{static_cast<std::uint32_t>(pixels->cols),
                                static_cast<std::uint32_t>(pixels->rows),
                                {pixels->begin<std::uint16_t>(), pixels->end<std::uint16_t>()}};
}

/// An RVL stream with its size in front: width and height, uint32 each.
Result<Decoded<std::uint16_t>> decode_rvl_image(const char* field, ByteView stream) {
  std::uint32_t size[2] = {};
  if (stream.size >= sizeof size) std::memcpy(size, stream.data, sizeof size);
  if (Status s = check_size(std::string(field) + " image", size[0], size[1]); !s.ok()) return s;
  Decoded<std::uint16_t> decoded{size[0], size[1], {}};
  const std::size_t count = std::size_t{size[0]} * size[1];
  if (!decode_rvl(stream.data + sizeof size, stream.size - sizeof size, count, decoded.pixels)) {
    return corrupt(field, " data is a damaged RVL stream");
  }
  return decoded;
}

/// Reads numbers of groups of four bits.
class Groups {
 public:
  Groups(const std::uint8_t* data, std::size_t size) : data_(data), left_(size / 4) {}

  bool ok() const { return ok_; }

  std::uint32_t number() {
    std::uint32_t value = 0;
    for (int shift = 0; shift < 32; shift += 3) {
      const std::uint32_t group = next();
      value |= (group & 7U) << static_cast<unsigned>(shift);
      if ((group & 8U) == 0) return value;
    }
    ok_ = false;  // more groups than a number has
    return 0;
  }

 private:
  std::uint32_t next() {
    if (in_word_ == 0) {
      if (left_ == 0) {
        ok_ = false;
        return 0;
      }
      std::memcpy(&word_, data_, 4);
      data_ += 4;
      --left_;
      in_word_ = 8;
    }
    const std::uint32_t group = word_ >> 28U;
    word_ <<= 4U;
    --in_word_;
    return group;
  }

  const std::uint8_t* data_;
  std::size_t left_;  ///< Words.
  std::uint32_t word_ = 0;
  int in_word_ = 0;
  bool ok_ = true;
};

bool has(std::string_view text, std::string_view word) {
  return text.find(word) != std::string_view::npos;
}

}  // namespace

bool decode_rvl(const std::uint8_t* data, std::size_t size, std::size_t count,
                std::vector<std::uint16_t>& values) {
  values.clear();
  // A group is half a byte and two numbers of one group may stand for any run of zeros, so memory
  // is taken for what the caller's size says.
  values.reserve(count);
  Groups groups(data, size);
  std::uint32_t last = 0;
  while (values.size() < count) {
    const std::uint32_t zeros = groups.number();
    const std::uint32_t others = groups.number();
    const std::size_t left = count - values.size();
    if (!groups.ok() || zeros > left || others > left - zeros || zeros + others == 0) return false;
    values.insert(values.end(), zeros, std::uint16_t{0});
    for (std::uint32_t i = 0; i < others; ++i) {
      const std::uint32_t zigzag = groups.number();
      if (!groups.ok()) return false;
      last += (zigzag >> 1U) ^ (~(zigzag & 1U) + 1U);
      values.push_back(static_cast<std::uint16_t>(last));
    }
  }
  return true;
}

Result<Decoded<std::uint8_t>> decode_color(const char* field, const CompressedImage& image) {
  // IMREAD_COLOR gives blue, green, red; alpha and more than 8 bits go.
  const auto decoded = decode_file(field, {image.data.data(), image.data.size()},
                                   cv::IMREAD_COLOR | cv::IMREAD_IGNORE_ORIENTATION);
  if (!decoded.ok()) return decoded.status();
  const cv::Mat& bgr = *decoded;
  const std::size_t split = image.format.find(';');
  const std::string_view encoded =
      split == std::string::npos ? "" : std::string_view(image.format).substr(split);
  const char* order = has(encoded, "compressed rgb") ? "rgb8" : "bgr8";
  const auto width = static_cast<std::uint32_t>(bgr.cols);
  const auto height = static_cast<std::uint32_t>(bgr.rows);
  auto rgb = color_from_image({field, order, width, height, 0, false, bgr.data, 3 * bgr.total()});
  if (!rgb.ok()) return rgb.status();
  return Decoded<std::uint8_t>{width, height, std::move(rgb).value()};
}

Result<Decoded<float>> decode_depth(const char* field, const CompressedImage& image) {
  const bool plugin = has(image.format, "compressedDepth");
  const bool inverse = plugin && image.format.rfind("32FC1", 0) == 0;
  const bool millimetres =
      image.format.rfind("16UC1", 0) == 0 || image.format.rfind("mono16", 0) == 0;
  if (!inverse && !millimetres) {
    return Status(StatusCode::unsupported,
                  concat(field, " format is \"", image.format,
                         "\"; it must begin with 16UC1, or be compressedDepth of 32FC1"));
  }
  ByteView file{image.data.data(), image.data.size()};
  float quantum[2] = {};
  if (plugin) {
    if (file.size < kDepthHeader) {
      return corrupt(field, " data has no compressedDepth header");
    }
    std::memcpy(quantum, file.data + 4, sizeof quantum);
    file = {file.data + kDepthHeader, file.size - kDepthHeader};
  }
  const auto values =
      has(image.format, "rvl") ? decode_rvl_image(field, file) : decode_png16(field, file);
  if (!values.ok()) return values.status();
  Decoded<float> result{values->width, values->height, {}};
  result.pixels.reserve(values->pixels.size());
  for (const std::uint16_t value : values->pixels) {
    float z = inverse && value != 0 ? quantum[0] / (static_cast<float>(value) - quantum[1])
                                    : static_cast<float>(value * 0.001);
    if (!std::isfinite(z) || z < 0) z = 0;
    result.pixels.push_back(z);
  }
  return result;
}

}  // namespace bpa::server
