// SPDX-FileCopyrightText: 2026 The bpa authors
// SPDX-License-Identifier: Apache-2.0
#include <algorithm>
#include <array>
#include <bit>
#include <charconv>

#include "core/base/concat.hpp"
#include "core/cloud/depth_unit.hpp"
#include "core/io/file_bytes.hpp"
#include "core/io/image_file.hpp"

namespace bpa::io {
namespace {

constexpr std::string_view kNpySignature("\x93NUMPY", 6);

/// Numbers as they lie in a file, in the other byte order if `swapped`.
template <class T>
std::vector<float> floats_of(std::string_view bytes, bool swapped, double factor) {
  std::vector<float> out;
  for (std::size_t at = 0; at < bytes.size(); at += sizeof(T)) {
    std::array<char, sizeof(T)> copy;
    std::copy_n(bytes.data() + at, sizeof(T), copy.begin());
    if (swapped) std::ranges::reverse(copy);
    out.push_back(static_cast<float>(factor * static_cast<double>(std::bit_cast<T>(copy))));
  }
  return out;
}

/// The next unsigned number of a text; 0 without one. Moves behind it.
int next_number(std::string_view& text) {
  constexpr std::string_view kDigits = "0123456789";
  text.remove_prefix(std::min(text.find_first_of(kDigits), text.size()));
  int number = 0;
  const auto [end, error] = std::from_chars(text.data(), text.data() + text.size(), number);
  text.remove_prefix(static_cast<std::size_t>(end - text.data()));
  return error == std::errc() ? number : 0;
}

Status check_depth_size(const std::string& path, const DepthImage& image, std::size_t bytes,
                        std::size_t pixel) {
  if (image.width < 1 || image.height < 1 || image.width > kMaxImageSide ||
      image.height > kMaxImageSide) {
    return invalid_argument(path, " has ", image.width, "x", image.height,
                            " pixels; each side must be 1 to ", kMaxImageSide);
  }
  const std::size_t needed = pixel * static_cast<std::size_t>(image.width) * image.height;
  if (bytes == needed) return {};
  return corrupt(path, " has ", bytes, " bytes of depth; it must have ", needed);
}

/// NumPy's format 1 to 3 (numpy.lib.format): a dictionary as text, then the array.
Result<DepthImage> parse_npy(const std::string& path, std::string_view bytes, double unit) {
  const auto at = [&](std::size_t i) { return static_cast<std::uint8_t>(bytes[i]); };
  if (bytes.size() < 12) return corrupt(path, " is truncated");
  const bool one = at(6) == 1;
  const std::size_t length = at(8) + 256U * at(9) + (one ? 0 : 65536U * at(10));
  const std::size_t begin = one ? 10 : 12;
  if (bytes.size() < begin + length) return corrupt(path, " is truncated");
  const std::string_view header = bytes.substr(begin, length);
  bytes.remove_prefix(begin + length);
  const auto value = [&](std::string_view key) {
    const std::size_t found = header.find(key);
    return found == header.npos ? std::string_view() : header.substr(found + key.size());
  };
  std::string_view shape = value("'shape':").substr(0, value("'shape':").find(')'));
  DepthImage image;
  image.height = next_number(shape);
  image.width = next_number(shape);
  const std::string_view quoted = value("'descr':");
  const std::string type(quoted.substr(std::min(quoted.find('\'') + 1, quoted.size()), 3));
  const bool swapped = type.starts_with('>');
  const std::string plain = type.substr(std::min<std::size_t>(1, type.size()));
  const int rest = next_number(shape);
  if (value("'fortran_order':").find("False") > 2 || rest > 1 ||
      (plain != "u2" && plain != "i4" && plain != "f4" && plain != "f8")) {
    return Status(StatusCode::unsupported, concat(path, " holds \"", type,
                                                  "\"; it must be one image of uint16, int32, "
                                                  "float32 or float64, row by row"));
  }
  const std::size_t pixel = static_cast<std::size_t>(plain[1] - '0');
  if (Status s = check_depth_size(path, image, bytes.size(), pixel); !s.ok()) return s;
  if (plain == "u2") image.metres = floats_of<std::uint16_t>(bytes, swapped, unit);
  if (plain == "i4") image.metres = floats_of<std::int32_t>(bytes, swapped, unit);
  if (plain == "f4") image.metres = floats_of<float>(bytes, swapped, 1);
  if (plain == "f8") image.metres = floats_of<double>(bytes, swapped, 1);
  if (plain[0] == 'f') image.note = to_metres(image.metres);
  return image;
}

/// Netpbm's binary grey format; its 16 bits are big-endian.
Result<DepthImage> parse_pgm(const std::string& path, std::string_view bytes, double unit) {
  std::string_view rest = bytes.substr(2);
  int numbers[3] = {};
  for (int& number : numbers) {
    const auto skip_to = [&](std::size_t at) { rest.remove_prefix(std::min(at, rest.size())); };
    skip_to(rest.find_first_not_of(" \t\r\n"));
    while (rest.starts_with('#')) {  // comments
      skip_to(rest.find('\n'));
      skip_to(rest.find_first_not_of(" \t\r\n"));
    }
    number = next_number(rest);
  }
  DepthImage image{numbers[0], numbers[1], {}};
  rest.remove_prefix(std::min<std::size_t>(1, rest.size()));
  if (numbers[2] < 256) {
    return invalid_argument(path, " has 8 bits a pixel; a depth image must have 16");
  }
  if (Status s = check_depth_size(path, image, rest.size(), 2); !s.ok()) return s;
  image.metres = floats_of<std::uint16_t>(rest, true, unit);
  return image;
}

/// How other files become ones that are read.
Status refused_depth(const std::string& path, std::string_view bytes) {
  const std::string extension = lower_extension(path);
  const auto is = [&](std::initializer_list<const char*> all) {
    return std::ranges::count(all, extension) > 0;
  };
  const auto python = [](const std::string& modules, const std::string& array) {
    return "write it as npy: python3 -c \"import " + modules + "; numpy.save('depth.npy', " +
           array + ")\"";
  };
  std::string way = "give one of these";
  if (const std::string content = content_of(bytes); !content.empty()) {
    way = "it is " + content;
    if (content.ends_with("JPEG image")) way += ", whose 8 bits hold no depths";
    if (content.ends_with("PLY file"))
      way += ": a mesh or cloud. Of clouds an organised PCD is read (--pcd)";
  } else if (is({"tif", "tiff", "exr", "pfm", "hdr", "jp2", "pgm", "pnm"})) {
    way = python("cv2, numpy", "cv2.imread('" + path + "', -1)");
    if (extension == "exr") way += ", with OPENCV_IO_ENABLE_OPENEXR=1";
  } else if (is({"raw", "bin", "dat", "depth"})) {
    way = python("numpy", "numpy.fromfile('" + path + "', 'u2').reshape(HEIGHT, WIDTH)");
  } else if (extension == "bag") {
    way = "write its images: rs-convert -i " + path +
          " -p OUT (RealSense), or play it to bpa-server (ros2 bag play)";
  } else if (extension == "mkv") {
    way = "write its images: python3 azure_kinect_mkv_reader.py --input " + path +
          " --output OUT (Open3D's examples)";
  }
  return Status(StatusCode::unsupported, path + " is no depth image in PNG, PGM or npy; " + way);
}

}  // namespace

DepthImage depth_of(const GrayImage& image, double scale_mm) {
  DepthImage depth{image.width, image.height, {}};
  for (const std::uint16_t units : image.pixels) {
    depth.metres.push_back(static_cast<float>(units * scale_mm * 0.001));
  }
  return depth;
}

Result<DepthImage> read_depth(const std::string& path, double scale_mm) {
  const Result<std::string> bytes = read_file(path);
  if (!bytes.ok()) return bytes.status();
  if (bytes->starts_with(kNpySignature)) return parse_npy(path, *bytes, 0.001 * scale_mm);
  if (bytes->starts_with("P5")) return parse_pgm(path, *bytes, 0.001 * scale_mm);
  const Result<GrayImage> image = decode_depth_png(*bytes, path);
  if (image.ok()) return depth_of(*image, scale_mm);
  if (bytes->starts_with("\x89PNG") || bytes->size() < 8) return image.status();
  return refused_depth(path, *bytes);
}

}  // namespace bpa::io
