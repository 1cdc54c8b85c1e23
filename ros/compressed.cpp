// SPDX-FileCopyrightText: 2026 The bpa authors
// SPDX-License-Identifier: Apache-2.0
#include <cmath>
#include <cstring>
#include <string>
#include <string_view>
#include <utility>

#include "core/base/concat.hpp"
#include "core/io/image_file.hpp"
#include "ros/images.hpp"

namespace bpa::ros {
namespace {

using wire::ByteView;
using wire::sensor_msgs::CompressedImage;

constexpr std::size_t kDepthHeader = 12;

std::string_view text_of(ByteView bytes) {
  return {reinterpret_cast<const char*>(bytes.data), bytes.size};
}

std::string name_of(const char* field) { return std::string(field) + " image"; }

Result<Decoded<std::uint16_t>> decode_png16(const char* field, ByteView file) {
  auto image = io::decode_depth_png(text_of(file), name_of(field));
  if (!image.ok()) return image.status();
  return Decoded<std::uint16_t>{static_cast<std::uint32_t>(image->width),
                                static_cast<std::uint32_t>(image->height),
                                std::move(image->pixels)};
}

/// An RVL stream with its size in front: width and height, uint32 each.
Result<Decoded<std::uint16_t>> decode_rvl_image(const char* field, ByteView stream) {
  std::uint32_t size[2] = {};
  if (stream.size >= sizeof size) std::memcpy(size, stream.data, sizeof size);
  if (Status s = check_size(name_of(field), size[0], size[1]); !s.ok()) return s;
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
  constexpr std::size_t kMaxPixels = std::size_t{io::kMaxImageSide} * io::kMaxImageSide;
  auto decoded = io::decode_color_image(text_of({image.data.data(), image.data.size()}),
                                        name_of(field), kMaxPixels);
  if (!decoded.ok()) return decoded.status();
  std::vector<std::uint8_t>& rgb = decoded->pixels;
  const std::size_t split = image.format.find(';');
  const std::string_view encoded =
      split == std::string::npos ? "" : std::string_view(image.format).substr(split);
  if (has(encoded, "compressed rgb")) {  // the file has red where readers expect blue
    for (std::size_t i = 0; i + 2 < rgb.size(); i += 3) std::swap(rgb[i], rgb[i + 2]);
  }
  return Decoded<std::uint8_t>{static_cast<std::uint32_t>(decoded->width),
                               static_cast<std::uint32_t>(decoded->height), std::move(rgb)};
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

}  // namespace bpa::ros
