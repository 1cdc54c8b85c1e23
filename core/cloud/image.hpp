// SPDX-FileCopyrightText: 2026 The bpa authors
// SPDX-License-Identifier: Apache-2.0
#pragma once

#include <cstddef>
#include <vector>

namespace bpa {

/// One value for each pixel, row-major. The images of a SurfaceMap have its size, and pixel i is
/// that of its points[i].
template <class T>
struct Image {
  int width = 0;
  int height = 0;
  std::vector<T> pixels;

  Image() = default;
  Image(int image_width, int image_height, const T& value)
      : width(image_width),
        height(image_height),
        pixels(static_cast<std::size_t>(image_width) * static_cast<std::size_t>(image_height),
               value) {}

  bool empty() const { return pixels.empty(); }
  std::size_t size() const { return pixels.size(); }
  bool contains(int u, int v) const { return u >= 0 && v >= 0 && u < width && v < height; }
  std::size_t index(int u, int v) const { return static_cast<std::size_t>(v * width + u); }
  T& operator[](std::size_t i) { return pixels[i]; }
  const T& operator[](std::size_t i) const { return pixels[i]; }
  T& at(int u, int v) { return pixels[index(u, v)]; }
  const T& at(int u, int v) const { return pixels[index(u, v)]; }
};

}  // namespace bpa
