// SPDX-FileCopyrightText: 2026 The bpa authors
// SPDX-License-Identifier: Apache-2.0
#pragma once

#include <string>

#include "core/io/image_file.hpp"

namespace cv {
class Mat;
}

// Private to draw: pictures as OpenCV's images (8-bit rgb), and words on them.

namespace bpa::draw {

/// A copy.
cv::Mat to_mat(const io::ColorImage& picture);
io::ColorImage to_image(const cv::Mat& image);

/// Dark ASCII text from the left end (x, y) of its base line, pixels. Size 1 is 22 pixels high.
void write(cv::Mat& image, const std::string& text, int x, int y, double size = 0.45);
/// Pixels.
int text_width(const std::string& text, double size = 0.45);

}  // namespace bpa::draw
