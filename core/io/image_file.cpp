// SPDX-FileCopyrightText: 2026 The bpa authors
// SPDX-License-Identifier: Apache-2.0
// OpenCV's codecs are private to this file. They allocate what a header says before anything here
// can refuse it. So headers are read here first, and only a file reaches them whose header they
// cannot read in another way: whatever stands in its place is refused, not skipped. libpng reports
// damage on stderr before OpenCV can say anything, so PNG checksums are compared here, too.
#include "core/io/image_file.hpp"

#include <algorithm>
#include <fstream>
#include <limits>
#include <optional>

#include <opencv2/imgcodecs.hpp>

#include "core/base/concat.hpp"
#include "core/io/file_bytes.hpp"

namespace bpa::io {
namespace {

constexpr std::string_view kPngSignature("\x89PNG\r\n\x1a\n", 8);
constexpr std::string_view kJpegSignature("\xff\xd8\xff", 3);
/// Each scan of a progressive JPEG costs time for all pixels. Encoders write about ten.
constexpr int kMaxJpegScans = 32;

std::uint32_t big_endian(std::string_view bytes, std::size_t at) {
  std::uint32_t value = 0;
  for (std::size_t i = 0; i < 4; ++i) value = value << 8 | static_cast<std::uint8_t>(bytes[at + i]);
  return value;
}

Status check_sides(const std::string& path, const ImageSize& size) {
  if (std::min(size.width, size.height) >= 1 &&
      std::max(size.width, size.height) <= kMaxImageSide) {
    return {};
  }
  return invalid_argument(path, " has ", size.width, "x", size.height,
                          " pixels; each side must be 1 to ", kMaxImageSide);
}

Result<ImageSize> parse_png_header(const std::string& path, std::string_view bytes) {
  if (bytes.substr(0, 8) != kPngSignature) return corrupt(path, " is not a PNG image");
  if (bytes.size() < 33) return corrupt(path, " is truncated");
  if (big_endian(bytes, 8) != 13 || bytes.substr(12, 4) != "IHDR") {
    return corrupt(path, " is damaged: a PNG must begin with IHDR");
  }
  ImageSize size;
  size.width = static_cast<int>(big_endian(bytes, 16) & 0x7fffffff);
  size.height = static_cast<int>(big_endian(bytes, 20) & 0x7fffffff);
  size.bit_depth = static_cast<std::uint8_t>(bytes[24]);
  const char color_type = bytes[25];
  size.channels = color_type == 0 ? 1 : color_type == 4 ? 2 : color_type == 6 ? 4 : 3;
  if (Status status = check_sides(path, size); !status.ok()) return status;
  return size;
}

/// Follows the segments of a JPEG to the frame header (ITU-T T.81, B.2.2). Of the markers that may
/// precede it (tables, restart interval, application data, comment), all begin a segment with a
/// length; any number of 0xff may precede a marker.
Result<ImageSize> parse_jpeg_header(const std::string& path, std::string_view bytes) {
  const auto byte = [&](std::size_t i) { return static_cast<std::uint8_t>(bytes[i]); };
  const auto number = [&](std::size_t i) { return byte(i) << 8 | byte(i + 1); };
  for (std::size_t at = 2; at + 10 <= bytes.size();) {
    const int marker = byte(at + 1);
    if (byte(at) == 0xff && marker == 0xff) {
      ++at;
      continue;
    }
    const bool table = marker == 0xc4 || marker == 0xcc || marker == 0xdb || marker == 0xdd;
    const bool frame = marker >= 0xc0 && marker <= 0xcf && !table && marker != 0xc8;
    const bool skipped = (marker >= 0xe0 && marker <= 0xef) || marker == 0xfe;
    const int length = number(at + 2);
    if (byte(at) != 0xff || length < 2 || !(table || frame || skipped)) {
      return corrupt(path, " is damaged: something else stands before the JPEG's frame header");
    }
    if (frame) {
      const ImageSize size{number(at + 7), number(at + 5), byte(at + 4), byte(at + 9)};
      if (Status status = check_sides(path, size); !status.ok()) return status;
      return size;
    }
    at += 2 + static_cast<std::size_t>(length);
  }
  return corrupt(path, " is truncated");
}

Status check_jpeg_scans(const std::string& path, std::string_view bytes) {
  int scans = 0;
  for (std::size_t at = 0; (at = bytes.find("\xff\xda", at)) != bytes.npos; at += 2) ++scans;
  if (scans <= kMaxJpegScans) return {};
  return Status(StatusCode::unsupported, concat(path, " is a JPEG of ", scans, " scans; at most ",
                                                kMaxJpegScans, " are read"));
}

/// The chunks that hold pixels, once every checksum to IEND was compared. All others, such as texts
/// and colour profiles, are left out: they say nothing of pixels, and unpack to gigabytes.
Result<std::string> pixel_chunks(const std::string& path, std::string_view bytes) {
  std::string chunks(kPngSignature);
  std::size_t at = kPngSignature.size();
  while (bytes.size() - at >= 12) {
    const std::size_t length = big_endian(bytes, at);
    if (length > bytes.size() - at - 12) break;
    const std::string_view content = bytes.substr(at + 4, length + 4);
    if (crc32(content) != big_endian(bytes, at + 8 + length)) {
      return corrupt(path, " is damaged: a PNG chunk does not match its checksum");
    }
    const std::string_view type = content.substr(0, 4);
    if (type == "IHDR" || type == "PLTE" || type == "IDAT" || type == "IEND") {
      chunks += bytes.substr(at, 12 + length);
    }
    if (type == "IEND") return chunks;
    at += 12 + length;
  }
  return corrupt(path, " is truncated");
}

/// Has OpenCV decode a file of that size.
Result<cv::Mat> decode_checked(const std::string& path, std::string_view bytes, int flags,
                               const ImageSize& size) {
  if (bytes.size() > std::numeric_limits<int>::max()) {
    return invalid_argument(path, " has ", bytes.size(),
                            " bytes; an image must have less than 2 GB");
  }
  cv::Mat image;
  try {
    image = cv::imdecode(
        cv::Mat(1, static_cast<int>(bytes.size()), CV_8U, const_cast<char*>(bytes.data())), flags);
  } catch (const std::exception&) {
  }
  if (image.empty() || image.cols != size.width || image.rows != size.height) {
    return corrupt(path, " is not an image that can be decoded");
  }
  return image;
}

/// Decodes a PNG, or with `jpeg_too` a JPEG, whose header passes check(size).
Result<cv::Mat> decode(const std::string& path, std::string_view bytes, int flags, bool jpeg_too,
                       const auto& check) {
  const bool jpeg = jpeg_too && bytes.starts_with(kJpegSignature);
  if (!jpeg && !bytes.starts_with(kPngSignature)) {
    if (kPngSignature.starts_with(bytes)) return corrupt(path, " is truncated");
    return Status(StatusCode::unsupported,
                  path + (jpeg_too ? " is not a PNG or JPEG image" : " is not a PNG image"));
  }
  const Result<ImageSize> size =
      jpeg ? parse_jpeg_header(path, bytes) : parse_png_header(path, bytes);
  if (!size.ok()) return size.status();
  if (Status status = check(*size); !status.ok()) return status;
  if (jpeg) {
    if (Status status = check_jpeg_scans(path, bytes); !status.ok()) return status;
    return decode_checked(path, bytes, flags, *size);
  }
  const Result<std::string> chunks = pixel_chunks(path, bytes);
  if (!chunks.ok()) return chunks.status();
  return decode_checked(path, *chunks, flags, *size);
}

Result<cv::Mat> read_image(const std::string& path, int flags, bool jpeg_too, const auto& check) {
  const Result<std::string> bytes = read_file(path);
  if (!bytes.ok()) return bytes.status();
  return decode(path, *bytes, flags, jpeg_too, check);
}

/// The file of width x height pixels of an OpenCV type, of which `pixels` holds `channels` values
/// each; `extension` is the kind of file.
template <class T>
Result<std::string> encoded(const std::string& path, int width, int height, int type, int channels,
                            const std::vector<T>& pixels, const char* extension = ".png",
                            const std::vector<int>& parameters = {}) {
  if (width < 1 || height < 1 || width > kMaxImageSide || height > kMaxImageSide ||
      pixels.size() != static_cast<std::size_t>(width * height * channels)) {
    return invalid_argument(path, ": the image has ", pixels.size(), " values; it must have ",
                            channels, " x ", width, " x ", height);
  }
  const cv::Mat image(height, width, type, const_cast<T*>(pixels.data()));
  std::vector<std::uint8_t> bytes;
  bool done = false;
  try {
    done = cv::imencode(extension, image, bytes, parameters);
  } catch (const std::exception&) {
  }
  if (!done) return Status(StatusCode::internal, path + " cannot be encoded");
  return std::string(bytes.begin(), bytes.end());
}

Status write_image(const std::string& path, const Result<std::string>& bytes) {
  if (!bytes.ok()) return bytes.status();
  // Of many images each would have to wait for the disk.
  return write_file(path, *bytes, Sync::later);
}

constexpr int kColorFlags = cv::IMREAD_COLOR | cv::IMREAD_IGNORE_ORIENTATION;

void swap_red_and_blue(std::vector<std::uint8_t>& pixels) {
  for (std::size_t i = 0; i + 2 < pixels.size(); i += 3) std::swap(pixels[i], pixels[i + 2]);
}

ColorImage to_color_image(const cv::Mat& bgr) {
  ColorImage image{bgr.cols, bgr.rows, {bgr.datastart, bgr.dataend}};
  swap_red_and_blue(image.pixels);
  return image;
}

GrayImage to_gray_image(const cv::Mat& gray) {
  GrayImage image{gray.cols, gray.rows, std::vector<std::uint16_t>(gray.total())};
  cv::Mat pixels(gray.size(), CV_16U, image.pixels.data());
  gray.convertTo(pixels, CV_16U);
  return image;
}

Result<std::string> encoded_color(const std::string& path, const ColorImage& image,
                                  const char* extension, const std::vector<int>& parameters) {
  std::vector<std::uint8_t> bgr = image.pixels;
  swap_red_and_blue(bgr);
  return encoded(path, image.width, image.height, CV_8UC3, 3, bgr, extension, parameters);
}

}  // namespace

Result<ImageSize> read_png_size(const std::string& path) {
  std::ifstream in(path, std::ios::binary);
  if (!in) return not_found(path, " cannot be opened");
  char head[33];
  in.read(head, sizeof head);
  return parse_png_header(path, {head, static_cast<std::size_t>(in.gcount())});
}

Result<ColorImage> read_color_image(const std::string& path) {
  const auto check = [&path](const ImageSize& size) -> Status {
    if (size.bit_depth == 8) return {};
    return invalid_argument(path, " has ", size.bit_depth,
                            " bits a channel; a colour image must have 8");
  };
  const Result<cv::Mat> image = read_image(path, kColorFlags, true, check);
  if (!image.ok()) return image.status();
  return to_color_image(*image);
}

Result<ColorImage> decode_color_image(std::string_view bytes, const std::string& name,
                                      std::size_t max_pixels) {
  const auto check = [&](const ImageSize& size) -> Status {
    const std::size_t pixels = static_cast<std::size_t>(size.width) * size.height;
    if (pixels <= max_pixels) return {};
    return invalid_argument(name, " has ", pixels, " pixels; at most ", max_pixels, " can be read");
  };
  const Result<cv::Mat> image = decode(name, bytes, kColorFlags, true, check);
  if (!image.ok()) return image.status();
  return to_color_image(*image);
}

Result<GrayImage> read_gray_png(const std::string& path) {
  const auto check = [&path](const ImageSize& size) -> Status {
    if (size.channels == 1 && (size.bit_depth == 8 || size.bit_depth == 16)) return {};
    return invalid_argument(path, " has ", size.channels, " channels of ", size.bit_depth,
                            " bits; a depth image must have 1 of 16");
  };
  const Result<cv::Mat> image = read_image(path, cv::IMREAD_UNCHANGED, false, check);
  if (!image.ok()) return image.status();
  return to_gray_image(*image);
}

Result<GrayImage> decode_depth_png(std::string_view bytes, const std::string& name) {
  const auto check = [&name](const ImageSize& size) -> Status {
    if (size.channels == 1 && size.bit_depth == 16) return {};
    return Status(StatusCode::unsupported,
                  concat(name, " has ", size.channels, " channels of ", size.bit_depth,
                         " bits; a depth image must have 1 of 16"));
  };
  const Result<cv::Mat> image = decode(name, bytes, cv::IMREAD_UNCHANGED, false, check);
  if (!image.ok()) return image.status();
  return to_gray_image(*image);
}

Result<std::string> encode_color_png(const ColorImage& image) {
  return encoded_color("the colour image", image, ".png", {});
}

Result<std::string> encode_gray_png(const GrayImage& image) {
  return encoded("the depth image", image.width, image.height, CV_16U, 1, image.pixels);
}

Result<std::string> encode_jpeg(const ColorImage& image, int quality) {
  return encoded_color("the picture", image, ".jpg", {cv::IMWRITE_JPEG_QUALITY, quality});
}

Status write_color_png(const std::string& path, const ColorImage& image) {
  return write_image(path, encoded_color(path, image, ".png", {}));
}

Status write_gray_png(const std::string& path, const GrayImage& image) {
  return write_image(path, encoded(path, image.width, image.height, CV_16U, 1, image.pixels));
}

Status write_mask_png(const std::string& path, int width, int height,
                      const std::vector<std::uint8_t>& mask) {
  return write_image(path, encoded(path, width, height, CV_8U, 1, mask));
}

Result<Frame> frame_of_images(const GrayImage& depth, const ColorImage* color, const Camera& camera,
                              double depth_scale_mm, const std::string& depth_name) {
  Frame frame;
  frame.camera = camera;
  if (camera.width == 0 && camera.height == 0) {
    frame.camera.width = depth.width;
    frame.camera.height = depth.height;
  }
  if (Status status = validate(frame.camera); !status.ok()) return status;
  if (depth.width != frame.camera.width || depth.height != frame.camera.height) {
    return invalid_argument("depth image ", depth_name, " is ", depth.width, "x", depth.height,
                            "; it must be ", frame.camera.width, "x", frame.camera.height,
                            " as the camera");
  }
  if (color != nullptr) {
    if (color->width != depth.width || color->height != depth.height) {
      return invalid_argument("depth image ", depth_name, " is ", depth.width, "x", depth.height,
                              "; it must have the size of the colour image, ", color->width, "x",
                              color->height);
    }
    frame.color = color->pixels;
  }
  for (const std::uint16_t units : depth.pixels) {
    frame.depth.push_back(static_cast<float>(units * depth_scale_mm * 0.001));
  }
  return frame;
}

Result<Frame> read_frame(const std::string& depth_path, const std::string& color_path,
                         const Camera& camera, double depth_scale_mm) {
  const Result<GrayImage> depth = read_gray_png(depth_path);
  if (!depth.ok()) return depth.status();
  std::optional<ColorImage> color;
  if (!color_path.empty()) {
    Result<ColorImage> read = read_color_image(color_path);
    if (!read.ok()) return read.status();
    color = std::move(read).value();
  }
  return frame_of_images(*depth, color ? &*color : nullptr, camera, depth_scale_mm, depth_path);
}

}  // namespace bpa::io
