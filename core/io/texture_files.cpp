// SPDX-FileCopyrightText: 2026 The bpa authors
// SPDX-License-Identifier: Apache-2.0
#include "core/io/private/texture_files.hpp"

#include <algorithm>
#include <cmath>
#include <cstdlib>
#include <filesystem>

#include "core/base/concat.hpp"
#include "core/cloud/cielab.hpp"
#include "core/io/file_bytes.hpp"
#include "core/io/image_file.hpp"

namespace bpa::io {
namespace fs = std::filesystem;
namespace {

/// Without the spaces that end a line of an MTL file, and with this system's slashes.
std::string cleaned(std::string name) {
  name.erase(name.find_last_not_of(" \t\r") + 1);
  std::ranges::replace(name, '\\', '/');
  return name;
}

/// The URI "my%20image.png" names "my image.png" (RFC 3986, 2.1).
std::string percent_decoded(const std::string& name) {
  std::string out;
  for (std::size_t i = 0; i < name.size(); ++i) {
    const std::string digits = name.substr(i + 1, 2);
    const bool escaped = name[i] == '%' && digits.size() == 2 &&
                         digits.find_first_not_of("0123456789abcdefABCDEF") == std::string::npos;
    out += escaped ? static_cast<char>(std::strtol(digits.c_str(), nullptr, 16)) : name[i];
    i += escaped ? 2 : 0;
  }
  return out;
}

RgbImage times(const ColorImage& image, const Eigen::Vector3f& factor) {
  std::array<std::array<std::uint8_t, 256>, 3> table;
  for (int c = 0; c < 3; ++c) {
    for (int value = 0; value < 256; ++value) {
      const double light = linear_of_srgb(value / 255.0) * static_cast<double>(factor[c]);
      const double scaled = 255 * srgb_of_linear(std::clamp(light, 0.0, 1.0));
      table[c][value] = static_cast<std::uint8_t>(std::lround(scaled));
    }
  }
  RgbImage out(image.width, image.height, {});
  for (std::size_t i = 0; i < out.size(); ++i) {
    for (std::size_t c = 0; c < 3; ++c) out[i][c] = table[c][image.pixels[3 * i + c]];
  }
  return out;
}

}  // namespace

Result<std::string> TextureFiles::read(const std::string& name) const {
  const fs::path folder = fs::path(mesh_path_).parent_path();
  for (const std::string& spelling : {name, percent_decoded(name)}) {
    for (const fs::path& path : {folder / spelling, folder / fs::path(spelling).filename()}) {
      std::error_code error;
      if (fs::is_regular_file(path, error)) return read_file(path.string());
    }
  }
  return not_found("texture ", name, " is neither there nor beside the mesh");
}

Result<int> TextureFiles::add(const TextureReference& reference, TriangleMesh& mesh) {
  const std::string name = cleaned(reference.name);
  const std::string key = concat(name, '\n', static_cast<int>(reference.wrap[0]),
                                 static_cast<int>(reference.wrap[1]), reference.factor.transpose());
  if (const auto known = indices_.find(key); known != indices_.end()) return known->second;
  const Result<std::string> bytes =
      reference.bytes.empty() ? read(name) : std::string(reference.bytes);
  if (!bytes.ok()) return bytes.status();
  const Result<ColorImage> image = decode_color_image(*bytes, "texture " + name, pixels_left_);
  if (!image.ok()) return image.status();
  const RgbImage scaled = times(*image, reference.factor);
  pixels_left_ -= scaled.size();
  mesh.textures.push_back(make_texture(scaled, reference.wrap));
  const int index = static_cast<int>(mesh.textures.size()) - 1;
  indices_[key] = index;
  return index;
}

}  // namespace bpa::io
