// SPDX-FileCopyrightText: 2026 The bpa authors
// SPDX-License-Identifier: Apache-2.0
#include "core/observation/check_image.hpp"

#include <cmath>

namespace bpa {

CheckImage make_check_image(const SurfaceMap& map) {
  CheckImage image;
  image.width = map.width();
  image.height = map.height();
  image.fx = static_cast<float>(map.camera.fx);
  image.fy = static_cast<float>(map.camera.fy);
  image.cx = static_cast<float>(map.camera.cx);
  image.cy = static_cast<float>(map.camera.cy);
  image.pixels.resize(map.size());
  for (std::size_t i = 0; i < map.size(); ++i) {
    CheckPixel& pixel = image.pixels[i];
    pixel.depth = map.depth[i];
    pixel.searched = map.searched[i];
    for (int k = 0; k < 3; ++k) {
      pixel.normal[k] = static_cast<std::int8_t>(std::lround(127 * map.normals[i][k]));
    }
  }
  return image;
}

}  // namespace bpa
