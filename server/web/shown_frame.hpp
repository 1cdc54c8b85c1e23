// SPDX-FileCopyrightText: 2026 The bpa authors
// SPDX-License-Identifier: Apache-2.0
#pragma once

#include <cstdint>
#include <functional>
#include <map>
#include <memory>
#include <mutex>
#include <string>

#include "core/base/status.hpp"
#include "core/cloud/frame.hpp"
#include "server/web/http.hpp"

namespace bpa::server::web {

/// A frame as viewers see it. Each picture is made when a viewer first asks for it, and once for
/// all viewers. Thread-safe.
class ShownFrame {
 public:
  /// `frame` gives the frame, or null where it cannot be decoded; it is called once, by the first
  /// that asks.
  explicit ShownFrame(std::function<std::shared_ptr<const Frame>()> frame)
      : make_(std::move(frame)) {}

  /// Null where there is none.
  std::shared_ptr<const Frame> frame();

  /// JPEG; depth as grey in a frame without colour.
  Result<Bytes> color();
  /// JPEG of depth in colours; see draw::depth_picture().
  Result<Bytes> depth();
  /// Points in binary: u32 their number; then x y z of each as i16 in millimetres; then r g b of
  /// each as u8. Little-endian. At most 80 000 points, spread over the frame.
  Result<Bytes> cloud();
  /// A tar archive of depth.png, color.png if there is colour, and camera.json, as `bpa detect`
  /// reads them, and result.json with this text.
  Result<Bytes> archive(const std::string& result_json);

 private:
  Result<Bytes> once(const char* name,
                     const std::function<Result<std::string>(const Frame&)>& make);

  std::mutex mutex_;
  std::function<std::shared_ptr<const Frame>()> make_;  ///< Empty once it was called.
  std::shared_ptr<const Frame> frame_;
  std::map<std::string, Bytes> made_;
};

}  // namespace bpa::server::web
