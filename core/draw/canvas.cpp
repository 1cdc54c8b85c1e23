// SPDX-FileCopyrightText: 2026 The bpa authors
// SPDX-License-Identifier: Apache-2.0
#include "core/draw/canvas.hpp"

#include <opencv2/imgproc.hpp>

namespace bpa::draw {
namespace {

constexpr int kFont = cv::FONT_HERSHEY_SIMPLEX;
const cv::Scalar kInk(40, 40, 40);

}  // namespace

cv::Mat to_mat(const io::ColorImage& picture) {
  auto* const pixels = const_cast<std::uint8_t*>(picture.pixels.data());
  return cv::Mat(picture.height, picture.width, CV_8UC3, pixels).clone();
}

io::ColorImage to_image(const cv::Mat& image) {
  const cv::Mat whole = image.isContinuous() ? image : image.clone();
  return {whole.cols, whole.rows, {whole.datastart, whole.dataend}};
}

void write(cv::Mat& image, const std::string& text, int x, int y, double size) {
  cv::putText(image, text, {x, y}, kFont, size, kInk, 1, cv::LINE_AA);
}

int text_width(const std::string& text, double size) {
  int below_base = 0;
  return cv::getTextSize(text, kFont, size, 1, &below_base).width;
}

}  // namespace bpa::draw
