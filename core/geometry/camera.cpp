// SPDX-FileCopyrightText: 2026 The bpa authors
// SPDX-License-Identifier: Apache-2.0
#include "core/geometry/camera.hpp"

#include <sstream>

namespace bpa {
namespace {

template <class Number>
Status rule_broken(const char* field, Number value, const std::string& rule) {
  std::ostringstream text;
  text << "camera " << field << " is " << value << "; it must be " << rule;
  return invalid_argument(text.str());
}

}  // namespace

Status validate(const Camera& camera) {
  const char* size_rule = "between 16 and 8192 pixels";
  if (camera.width < 16 || camera.width > 8192)
    return rule_broken("width", camera.width, size_rule);
  if (camera.height < 16 || camera.height > 8192)
    return rule_broken("height", camera.height, size_rule);
  const char* focal_rule = "a focal length in pixels, greater than 0";
  if (!(camera.fx > 0 && camera.fx < 1e6)) return rule_broken("fx", camera.fx, focal_rule);
  if (!(camera.fy > 0 && camera.fy < 1e6)) return rule_broken("fy", camera.fy, focal_rule);
  const char* centre_rule = "within one image size of the image";
  if (!(camera.cx > -camera.width && camera.cx < 2 * camera.width))
    return rule_broken("cx", camera.cx, centre_rule);
  if (!(camera.cy > -camera.height && camera.cy < 2 * camera.height))
    return rule_broken("cy", camera.cy, centre_rule);
  return {};
}

}  // namespace bpa
