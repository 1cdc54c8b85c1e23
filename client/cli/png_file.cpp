// SPDX-FileCopyrightText: 2026 The bpa authors
// SPDX-License-Identifier: Apache-2.0
#include "client/cli/png_file.hpp"

#include <csetjmp>
#include <cstdio>
#include <cstring>
#include <memory>

#include <png.h>

namespace bpa::cli {
namespace {

struct FileCloser {
  void operator()(std::FILE* file) const { std::fclose(file); }
};
using File = std::unique_ptr<std::FILE, FileCloser>;

/// libpng's state for one file. libpng reports errors by longjmp, so the functions that it jumps
/// out of own nothing; this does.
struct Reader {
  png_structp png = nullptr;
  png_infop info = nullptr;
  std::string error;

  Reader() {
    png = png_create_read_struct(PNG_LIBPNG_VER_STRING, this, on_error, [](png_structp, auto) {});
    if (png != nullptr) info = png_create_info_struct(png);
  }
  ~Reader() { png_destroy_read_struct(&png, &info, nullptr); }
  Reader(const Reader&) = delete;
  Reader& operator=(const Reader&) = delete;

  static void on_error(png_structp png, png_const_charp text) {
    static_cast<Reader*>(png_get_error_ptr(png))->error = text;
    png_longjmp(png, 1);
  }
};

/// Reads the whole file into the reader; false when it is broken.
bool read_all(Reader& reader, std::FILE* file, int transforms) {
  if (setjmp(png_jmpbuf(reader.png)) != 0) return false;
  png_set_user_limits(reader.png, 8192, 8192);
  png_init_io(reader.png, file);
  png_read_png(reader.png, reader.info, transforms, nullptr);
  return true;
}

Status read_file(const std::string& path, int transforms, Reader& reader) {
  const File file(std::fopen(path.c_str(), "rb"));
  if (!file) return {StatusCode::not_found, path + ": there is no such file"};
  if (reader.info == nullptr) return {StatusCode::internal, "libpng has no memory"};
  if (read_all(reader, file.get(), transforms)) return {};
  return {StatusCode::corrupt, path + ": not a whole PNG file: " + reader.error};
}

template <class Pixel>
std::vector<Pixel> pixels_of(const Reader& reader, std::size_t per_pixel) {
  const std::size_t width = png_get_image_width(reader.png, reader.info);
  const std::size_t height = png_get_image_height(reader.png, reader.info);
  const png_bytepp rows = png_get_rows(reader.png, reader.info);
  std::vector<Pixel> pixels(width * height * per_pixel);
  const std::size_t row_bytes = width * per_pixel * sizeof(Pixel);
  for (std::size_t v = 0; v < height; ++v) {
    std::memcpy(pixels.data() + v * width * per_pixel, rows[v], row_bytes);
  }
  return pixels;
}

}  // namespace

Result<RgbImage> read_color_png(const std::string& path) {
  Reader reader;
  const int transforms = PNG_TRANSFORM_EXPAND | PNG_TRANSFORM_STRIP_16 | PNG_TRANSFORM_STRIP_ALPHA |
                         PNG_TRANSFORM_GRAY_TO_RGB;
  if (Status status = read_file(path, transforms, reader); !status.ok()) return status;
  RgbImage image;
  image.width = static_cast<int>(png_get_image_width(reader.png, reader.info));
  image.height = static_cast<int>(png_get_image_height(reader.png, reader.info));
  image.rgb = pixels_of<std::uint8_t>(reader, 3);
  return image;
}

Result<DepthImage> read_depth_png(const std::string& path) {
  Reader reader;
  if (Status status = read_file(path, PNG_TRANSFORM_SWAP_ENDIAN, reader); !status.ok()) {
    return status;
  }
  if (png_get_bit_depth(reader.png, reader.info) != 16 ||
      png_get_color_type(reader.png, reader.info) != PNG_COLOR_TYPE_GRAY) {
    return invalid_argument(path + ": a depth image must be a grey PNG of 16 bits");
  }
  DepthImage image;
  image.width = static_cast<int>(png_get_image_width(reader.png, reader.info));
  image.height = static_cast<int>(png_get_image_height(reader.png, reader.info));
  image.pixels = pixels_of<std::uint16_t>(reader, 1);
  return image;
}

Status write_depth_png(const std::string& path, int width, int height,
                       const std::vector<std::uint16_t>& pixels) {
  png_image image{};
  image.version = PNG_IMAGE_VERSION;
  image.width = static_cast<png_uint_32>(width);
  image.height = static_cast<png_uint_32>(height);
  image.format = PNG_FORMAT_LINEAR_Y;  // 16 bits as they are: the file says "linear"
  image.flags = PNG_IMAGE_FLAG_FAST;
  if (png_image_write_to_file(&image, path.c_str(), 0, pixels.data(), 0, nullptr) != 0) return {};
  return {StatusCode::unavailable, path + ": cannot be written: " + image.message};
}

Status write_png(const std::string& path, int width, int height,
                 const std::vector<std::uint8_t>& rgb, bool fast) {
  if (rgb.size() !=
      std::size_t{3} * static_cast<std::size_t>(width) * static_cast<std::size_t>(height)) {
    return invalid_argument(path + ": the image has " + std::to_string(rgb.size()) +
                            " bytes; it must have 3 x width x height");
  }
  png_image image{};
  image.version = PNG_IMAGE_VERSION;
  image.width = static_cast<png_uint_32>(width);
  image.height = static_cast<png_uint_32>(height);
  image.format = PNG_FORMAT_RGB;
  image.flags = fast ? PNG_IMAGE_FLAG_FAST : 0;
  if (png_image_write_to_file(&image, path.c_str(), 0, rgb.data(), 0, nullptr) != 0) return {};
  return {StatusCode::unavailable, path + ": cannot be written: " + image.message};
}

}  // namespace bpa::cli
