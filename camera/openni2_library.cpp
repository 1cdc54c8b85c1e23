// SPDX-FileCopyrightText: 2026 The bpa authors
// SPDX-License-Identifier: Apache-2.0
#include "camera/openni2_library.hpp"

#include <openni2/OpenNI.h>

namespace bpa::camera {

std::string openni2_error() {
  std::string text;
  for (const char* c = openni::OpenNI::getExtendedError(); *c != '\0'; ++c) {
    const bool space = *c == '\n' || *c == '\t' || *c == '\r';
    if (!space) {
      text += *c;
    } else if (!text.empty() && text.back() != ' ') {
      text += c[1] != '\0' ? "; " : "";
    }
  }
  while (!text.empty() && (text.back() == ' ' || text.back() == ';')) text.pop_back();
  return text.empty() ? "OpenNI2 does not say why" : text;
}

Result<std::shared_ptr<Openni2Library>> Openni2Library::load() {
  if (openni::OpenNI::initialize() != openni::STATUS_OK) {
    const std::string why = openni2_error();
    openni::OpenNI::shutdown();
    return Status(StatusCode::unavailable, "OpenNI2 cannot start: " + why);
  }
  return std::shared_ptr<Openni2Library>(new Openni2Library());
}

Openni2Library::~Openni2Library() { openni::OpenNI::shutdown(); }

}  // namespace bpa::camera
