// SPDX-FileCopyrightText: 2026 The bpa authors
// SPDX-License-Identifier: Apache-2.0
#include "server/web/shown_frame.hpp"

#include <algorithm>
#include <cmath>
#include <cstring>
#include <utility>
#include <vector>

#include "core/base/concat.hpp"
#include "core/draw/annotate.hpp"
#include "core/draw/sheet.hpp"
#include "core/io/camera_file.hpp"
#include "core/io/image_file.hpp"

namespace bpa::server::web {
namespace {

constexpr int kJpegQuality = 80;             ///< 40 to 80 KB at 640 x 480.
constexpr std::size_t kShownPoints = 80000;  ///< A quarter of 640 x 480, 0.7 MB.
constexpr double kMetresPerUnit = 0.001;     ///< Of saved depth images.
constexpr float kUnitsPerMetre = 1000;

/// Little-endian, as on all machines that this runs on.
template <class T>
void append(std::string& bytes, const T& value) {
  bytes.append(reinterpret_cast<const char*>(&value), sizeof value);
}

std::string cloud_of(const Frame& frame) {
  const Camera& camera = frame.camera;
  const auto known =
      static_cast<std::size_t>(std::ranges::count_if(frame.depth, [](float z) { return z > 0; }));
  int step = 1;
  while (known / static_cast<std::size_t>(step * step) > kShownPoints) ++step;
  std::string points, colors;
  std::uint32_t count = 0;
  for (int v = 0; v < camera.height; v += step) {
    for (int u = 0; u < camera.width; u += step) {
      const auto i = static_cast<std::size_t>(v * camera.width + u);
      if (!(frame.depth[i] > 0)) continue;
      const Eigen::Vector3d point = camera.unproject(u, v, static_cast<double>(frame.depth[i]));
      for (const double x : point) {
        append(points,
               static_cast<std::int16_t>(std::clamp(x / kMetresPerUnit, -32768.0, 32767.0)));
      }
      for (std::size_t c = 0; c < 3; ++c) {
        append(colors, frame.color.empty() ? std::uint8_t{180} : frame.color[3 * i + c]);
      }
      ++count;
    }
  }
  std::string bytes;
  append(bytes, count);
  append(bytes, static_cast<float>(step / camera.fx));
  return bytes + points + colors;
}

Result<std::string> depth_png(const Frame& frame) {
  io::GrayImage image{frame.camera.width, frame.camera.height, {}};
  for (const float z : frame.depth) {
    image.pixels.push_back(
        static_cast<std::uint16_t>(std::min(65535L, std::lround(z * kUnitsPerMetre))));
  }
  return io::encode_gray_png(image);
}

/// One file of an archive (POSIX.1-1988, ustar): a head of 512 bytes, then the content in blocks.
void add_file(std::string& archive, const std::string& name, const std::string& content) {
  constexpr std::size_t kBlock = 512;
  char head[kBlock] = {};
  const auto put = [&head](std::size_t at, const std::string& text) {
    std::copy(text.begin(), text.end(), head + at);
  };
  put(0, name);
  put(100, "0000644");
  put(108, "0000000");
  put(116, "0000000");
  put(124, format("%011zo", content.size()));
  put(136, "00000000000");
  put(148, "        ");  // the checksum counts as blanks
  put(156, "0");
  put(257, "ustar");
  put(263, "00");
  unsigned sum = 0;
  for (const char c : head) sum += static_cast<unsigned char>(c);
  put(148, format("%06o", sum) + std::string("\0 ", 2));
  archive.append(head, kBlock);
  archive += content;
  archive.append((kBlock - content.size() % kBlock) % kBlock, '\0');
}

}  // namespace

std::shared_ptr<const Frame> ShownFrame::frame() {
  const std::lock_guard<std::mutex> lock(mutex_);
  if (make_) frame_ = std::exchange(make_, nullptr)();
  return frame_;
}

Result<Bytes> ShownFrame::once(const char* name,
                               const std::function<Result<std::string>(const Frame&)>& make) {
  const std::shared_ptr<const Frame> shown = frame();
  const std::lock_guard<std::mutex> lock(mutex_);
  if (const auto found = made_.find(name); found != made_.end()) return found->second;
  if (!shown) return not_found("this frame cannot be decoded; the log says why");
  Result<std::string> bytes = make(*shown);
  if (!bytes.ok()) return bytes.status();
  return made_[name] = std::make_shared<const std::string>(std::move(bytes).value());
}

Result<Bytes> ShownFrame::color() {
  return once("color", [](const Frame& frame) {
    return io::encode_jpeg(draw::objects(frame, {}), kJpegQuality);
  });
}

Result<Bytes> ShownFrame::depth() {
  return once("depth", [](const Frame& frame) {
    return io::encode_jpeg(draw::depth_picture(frame), kJpegQuality);
  });
}

Result<Bytes> ShownFrame::cloud() {
  return once("cloud", [](const Frame& frame) -> Result<std::string> { return cloud_of(frame); });
}

Result<Bytes> ShownFrame::archive(const std::string& result_json) {
  const std::shared_ptr<const Frame> shown = frame();
  if (!shown) return not_found("this frame cannot be decoded; the log says why");
  std::string archive;
  const Result<std::string> depth = depth_png(*shown);
  if (!depth.ok()) return depth.status();
  add_file(archive, "depth.png", *depth);
  if (!shown->color.empty()) {
    const Result<std::string> color =
        io::encode_color_png({shown->camera.width, shown->camera.height, shown->color});
    if (!color.ok()) return color.status();
    add_file(archive, "color.png", *color);
  }
  add_file(archive, "camera.json", io::camera_json(shown->camera, 1));
  add_file(archive, "result.json", result_json);
  constexpr std::size_t kEnd = 1024;  // two empty blocks
  return std::make_shared<const std::string>(archive + std::string(kEnd, '\0'));
}

}  // namespace bpa::server::web
