// SPDX-FileCopyrightText: 2026 The bpa authors
// SPDX-License-Identifier: Apache-2.0
// libpng and libjpeg-turbo are private to this file. They allocate what a header says before
// anything here can refuse it. So headers are read here first, and only a file reaches them whose
// header they cannot read in another way: whatever stands in its place is refused, not skipped.
// OpenCV's codecs bring GDAL and what that needs: 120 libraries, which take 70 ms to load.
#include "core/io/image_file.hpp"

#include <algorithm>
#include <bit>
#include <csetjmp>
#include <fstream>
#include <memory>
#include <optional>

#include <png.h>
#include <turbojpeg.h>
#include <zlib.h>

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

Status not_decodable(const std::string& path) {
  return corrupt(path, " is not an image that can be decoded");
}

/// Has libpng decode the pixel chunks of a file of that size to rows of PNG_FORMAT_... pixels
/// without padding.
template <class T>
Status decode_png(const std::string& path, std::string_view bytes, const ImageSize& size,
                  png_uint_32 format, std::vector<T>& pixels) {
  const Result<std::string> chunks = pixel_chunks(path, bytes);
  if (!chunks.ok()) return chunks.status();
  png_image image{};
  image.version = PNG_IMAGE_VERSION;
  if (png_image_begin_read_from_memory(&image, chunks->data(), chunks->size()) == 0) {
    return not_decodable(path);
  }
  const auto free = [](png_image* read) { png_image_free(read); };
  const std::unique_ptr<png_image, decltype(free)> owner(&image, free);
  if (static_cast<int>(image.width) != size.width ||
      static_cast<int>(image.height) != size.height) {
    return not_decodable(path);
  }
  // Colours of 16 bits are those of 8 bits, not linear in light. Depth is not colour.
  if ((format & PNG_FORMAT_FLAG_COLOR) != 0) image.flags |= PNG_IMAGE_FLAG_16BIT_sRGB;
  image.format = format;
  pixels.resize(PNG_IMAGE_SIZE(image) / sizeof(T));
  if (png_image_finish_read(&image, nullptr, pixels.data(), 0, nullptr) == 0) {
    return not_decodable(path);
  }
  return {};
}

struct CloseJpeg {
  void operator()(void* handle) const { tjDestroy(handle); }
};
using Jpeg = std::unique_ptr<void, CloseJpeg>;

/// Has libjpeg-turbo decode a file of that size to rgb.
Result<ColorImage> decode_jpeg(const std::string& path, std::string_view bytes,
                               const ImageSize& size) {
  if (Status status = check_jpeg_scans(path, bytes); !status.ok()) return status;
  const Jpeg jpeg(tjInitDecompress());
  const auto* data = reinterpret_cast<const unsigned char*>(bytes.data());
  const bool cmyk = size.channels == 4;
  const std::size_t channels = cmyk ? 4 : 3;
  std::vector<std::uint8_t> pixels(channels * size.width * size.height);
  int width = 0, height = 0, subsampling = 0, colorspace = 0;
  if (tjDecompressHeader3(jpeg.get(), data, bytes.size(), &width, &height, &subsampling,
                          &colorspace) != 0 ||
      width != size.width || height != size.height) {
    return not_decodable(path);
  }
  // What libjpeg-turbo only warns of, such as bytes between segments, is read as far as it goes.
  if (tjDecompress2(jpeg.get(), data, bytes.size(), pixels.data(), width, 0, height,
                    cmyk ? TJPF_CMYK : TJPF_RGB, 0) != 0 &&
      tjGetErrorCode(jpeg.get()) != TJERR_WARNING) {
    return not_decodable(path);
  }
  ColorImage image{width, height, {}};
  if (!cmyk) {
    image.pixels = std::move(pixels);
    return image;
  }
  for (std::size_t i = 0; i < pixels.size(); i += 4) {  // inks are stored inverted
    for (std::size_t c = 0; c < 3; ++c) {
      image.pixels.push_back(static_cast<std::uint8_t>(pixels[i + c] * pixels[i + 3] / 255));
    }
  }
  return image;
}

/// The size of a PNG, or with `jpeg_too` of a JPEG, which passes check(size).
Result<ImageSize> checked_size(const std::string& path, std::string_view bytes, bool jpeg_too,
                               const auto& check) {
  const bool jpeg = jpeg_too && bytes.starts_with(kJpegSignature);
  if (!jpeg && !bytes.starts_with(kPngSignature)) {
    if (kPngSignature.starts_with(bytes)) return corrupt(path, " is truncated");
    const std::string content = content_of(bytes);
    return Status(content.empty() ? StatusCode::unsupported : StatusCode::corrupt,
                  path + (jpeg_too ? " is not a PNG or JPEG image" : " is not a PNG image") +
                      (content.empty() ? "" : ", but " + content));
  }
  Result<ImageSize> size = jpeg ? parse_jpeg_header(path, bytes) : parse_png_header(path, bytes);
  if (!size.ok()) return size;
  if (Status status = check(*size); !status.ok()) return status;
  return size;
}

Result<ColorImage> decode_color(const std::string& path, std::string_view bytes,
                                const auto& check) {
  const Result<ImageSize> size = checked_size(path, bytes, true, check);
  if (!size.ok()) return size.status();
  if (bytes.starts_with(kJpegSignature)) return decode_jpeg(path, bytes, *size);
  ColorImage image{size->width, size->height, {}};
  if (size->bit_depth == 16 && size->channels == 1) {
    std::vector<std::uint16_t> grey;
    Status status = decode_png(path, bytes, *size, PNG_FORMAT_LINEAR_Y, grey);
    if (!status.ok()) return status;
    image.pixels = rgb_of_grey(grey);
    return image;
  }
  const bool alpha = size->channels == 2 || size->channels == 4;
  Status status =
      decode_png(path, bytes, *size, alpha ? PNG_FORMAT_RGBA : PNG_FORMAT_RGB, image.pixels);
  if (!status.ok()) return status;
  if (alpha) {
    std::size_t kept = 0;
    for (std::size_t i = 0; i < image.pixels.size(); ++i) {
      if (i % 4 != 3) image.pixels[kept++] = image.pixels[i];
    }
    image.pixels.resize(kept);
  }
  return image;
}

Result<GrayImage> decode_gray(const std::string& path, std::string_view bytes, const auto& check) {
  const Result<ImageSize> size = checked_size(path, bytes, false, check);
  if (!size.ok()) return size.status();
  GrayImage image{size->width, size->height, {}};
  if (size->bit_depth == 16) {
    Status status = decode_png(path, bytes, *size, PNG_FORMAT_LINEAR_Y, image.pixels);
    if (!status.ok()) return status;
    return image;
  }
  std::vector<std::uint8_t> pixels;
  if (Status status = decode_png(path, bytes, *size, PNG_FORMAT_GRAY, pixels); !status.ok()) {
    return status;
  }
  image.pixels.assign(pixels.begin(), pixels.end());
  return image;
}

Status check_pixels(const std::string& path, int width, int height, std::size_t channels,
                    std::size_t values) {
  if (width >= 1 && height >= 1 && width <= kMaxImageSide && height <= kMaxImageSide &&
      values == channels * static_cast<std::size_t>(width) * static_cast<std::size_t>(height)) {
    return {};
  }
  return invalid_argument(path, ": the image has ", values, " values; it must have ", channels,
                          " x ", width, " x ", height);
}

void append_to_string(png_structp png, png_bytep data, std::size_t size) {
  static_cast<std::string*>(png_get_io_ptr(png))->append(reinterpret_cast<const char*>(data), size);
}

/// Appends the PNG of an image to a string that has room for it. False where libpng fails, which
/// then jumps: nothing here has a destructor. libpng's simple interface takes twice the time.
bool append_png(const std::uint8_t* pixels, int width, int height, int color_type, int bit_depth,
                std::string& bytes) {
  png_structp png = png_create_write_struct(PNG_LIBPNG_VER_STRING, nullptr, nullptr, nullptr);
  png_infop info = png ? png_create_info_struct(png) : nullptr;
  if (info == nullptr || setjmp(png_jmpbuf(png)) != 0) {
    png_destroy_write_struct(&png, &info);
    return false;
  }
  png_set_write_fn(png, &bytes, append_to_string, nullptr);
  png_set_compression_level(png, Z_BEST_SPEED);
  png_set_compression_strategy(png, Z_RLE);
  png_set_filter(png, PNG_FILTER_TYPE_BASE, PNG_FILTER_SUB);
  png_set_IHDR(png, info, static_cast<png_uint_32>(width), static_cast<png_uint_32>(height),
               bit_depth, color_type, PNG_INTERLACE_NONE, PNG_COMPRESSION_TYPE_DEFAULT,
               PNG_FILTER_TYPE_DEFAULT);
  png_write_info(png, info);
  if (bit_depth == 16) png_set_swap(png);
  const std::size_t stride = png_get_rowbytes(png, info);
  for (int y = 0; y < height; ++y)
    png_write_row(png, pixels + stride * static_cast<std::size_t>(y));
  png_write_end(png, info);
  png_destroy_write_struct(&png, &info);
  return true;
}

/// The PNG of width x height pixels, gray or rgb.
template <class T>
Result<std::string> encoded_png(const std::string& path, int width, int height, int color_type,
                                const std::vector<T>& pixels) {
  const std::size_t channels = color_type == PNG_COLOR_TYPE_RGB ? 3 : 1;
  if (Status status = check_pixels(path, width, height, channels, pixels.size()); !status.ok()) {
    return status;
  }
  std::string bytes;
  bytes.reserve(2 * sizeof(T) * pixels.size() + 65536);
  const auto* data = reinterpret_cast<const std::uint8_t*>(pixels.data());
  if (!append_png(data, width, height, color_type, 8 * sizeof(T), bytes)) {
    return Status(StatusCode::internal, path + " cannot be encoded");
  }
  bytes.shrink_to_fit();
  return bytes;
}

Status write_image(const std::string& path, const Result<std::string>& bytes) {
  if (!bytes.ok()) return bytes.status();
  // Of many images each would have to wait for the disk.
  return write_file(path, *bytes, Sync::later);
}

}  // namespace

Result<ImageSize> read_png_size(const std::string& path) {
  std::ifstream in(path, std::ios::binary);
  if (!in) return not_found(path, " cannot be opened");
  char head[33];
  in.read(head, sizeof head);
  return parse_png_header(path, {head, static_cast<std::size_t>(in.gcount())});
}

std::vector<std::uint8_t> rgb_of_grey(std::span<const std::uint16_t> grey) {
  std::vector<std::uint8_t> rgb;
  if (grey.empty()) return rgb;
  const int shift = std::max(0, std::bit_width(*std::ranges::max_element(grey)) - 8);
  rgb.reserve(3 * grey.size());
  for (const std::uint16_t value : grey) {
    rgb.insert(rgb.end(), 3, static_cast<std::uint8_t>(value >> shift));
  }
  return rgb;
}

Result<ColorImage> read_color_image(const std::string& path) {
  const Result<std::string> bytes = read_file(path);
  if (!bytes.ok()) return bytes.status();
  Result<ColorImage> image = decode_color(path, *bytes, [](const ImageSize&) { return Status(); });
  if (image.status().code != StatusCode::unsupported) return image;
  return Status(StatusCode::unsupported,
                image.status().message + "; write it as one: python3 -c \"import cv2; " +
                    "cv2.imwrite('color.png', cv2.imread('" + path + "'))\"");
}

Result<ColorImage> decode_color_image(std::string_view bytes, const std::string& name,
                                      std::size_t max_pixels) {
  const auto check = [&](const ImageSize& size) -> Status {
    const std::size_t pixels = static_cast<std::size_t>(size.width) * size.height;
    if (pixels <= max_pixels) return {};
    return invalid_argument(name, " has ", pixels, " pixels; at most ", max_pixels, " can be read");
  };
  return decode_color(name, bytes, check);
}

Result<GrayImage> read_gray_png(const std::string& path) {
  const auto check = [&path](const ImageSize& size) -> Status {
    if (size.channels == 1 && (size.bit_depth == 8 || size.bit_depth == 16)) return {};
    return invalid_argument(path, " has ", size.channels, " channels of ", size.bit_depth,
                            " bits; a depth image must have 1 of 16");
  };
  const Result<std::string> bytes = read_file(path);
  if (!bytes.ok()) return bytes.status();
  return decode_gray(path, *bytes, check);
}

Result<GrayImage> decode_depth_png(std::string_view bytes, const std::string& name) {
  const auto check = [&name](const ImageSize& size) -> Status {
    if (size.channels == 1 && size.bit_depth == 16) return {};
    return Status(StatusCode::unsupported,
                  concat(name, " has ", size.channels, " channels of ", size.bit_depth,
                         " bits; a depth image must have 1 of 16",
                         size.bit_depth == 8 ? ": a picture for people holds no depths" : ""));
  };
  return decode_gray(name, bytes, check);
}

Result<std::string> encode_color_png(const ColorImage& image) {
  return encoded_png("the colour image", image.width, image.height, PNG_COLOR_TYPE_RGB,
                     image.pixels);
}

Result<std::string> encode_gray_png(const GrayImage& image) {
  return encoded_png("the depth image", image.width, image.height, PNG_COLOR_TYPE_GRAY,
                     image.pixels);
}

Result<std::string> encode_jpeg(const ColorImage& image, int quality) {
  const std::string name = "the picture";
  Status status = check_pixels(name, image.width, image.height, 3, image.pixels.size());
  if (!status.ok()) return status;
  const Jpeg jpeg(tjInitCompress());
  unsigned char* bytes = nullptr;
  unsigned long size = 0;
  const int failed = tjCompress2(jpeg.get(), image.pixels.data(), image.width, 0, image.height,
                                 TJPF_RGB, &bytes, &size, TJSAMP_420, quality, 0);
  const std::unique_ptr<unsigned char, decltype(&tjFree)> owner(bytes, tjFree);
  if (failed != 0) return Status(StatusCode::internal, name + " cannot be encoded");
  return std::string(bytes, bytes + size);
}

Status write_color_png(const std::string& path, const ColorImage& image) {
  return write_image(
      path, encoded_png(path, image.width, image.height, PNG_COLOR_TYPE_RGB, image.pixels));
}

Status write_gray_png(const std::string& path, const GrayImage& image) {
  return write_image(
      path, encoded_png(path, image.width, image.height, PNG_COLOR_TYPE_GRAY, image.pixels));
}

Status write_mask_png(const std::string& path, int width, int height,
                      const std::vector<std::uint8_t>& mask) {
  return write_image(path, encoded_png(path, width, height, PNG_COLOR_TYPE_GRAY, mask));
}

Result<Frame> frame_of_images(DepthImage depth, const ColorImage* color, const Camera& camera,
                              const std::string& depth_name) {
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
  frame.depth = std::move(depth.metres);
  return frame;
}

Result<Frame> read_frame(const std::string& depth_path, const std::string& color_path,
                         const Camera& camera, double depth_scale_mm, std::string* note) {
  Result<DepthImage> depth = read_depth(depth_path, depth_scale_mm);
  if (!depth.ok()) return depth.status();
  if (note != nullptr) *note = depth->note;
  std::optional<ColorImage> color;
  if (!color_path.empty()) {
    Result<ColorImage> read = read_color_image(color_path);
    if (!read.ok()) return read.status();
    color = std::move(read).value();
  }
  return frame_of_images(std::move(depth).value(), color ? &*color : nullptr, camera, depth_path);
}

}  // namespace bpa::io
