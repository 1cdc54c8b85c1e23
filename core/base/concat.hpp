// SPDX-FileCopyrightText: 2026 The bpa authors
// SPDX-License-Identifier: Apache-2.0
#pragma once

#include <cmath>
#include <cstdarg>
#include <cstdio>
#include <sstream>

#include "core/base/status.hpp"

// Texts put together of parts, and statuses that say them. For source files.

namespace bpa {

/// The parts one after the other, as a stream writes them.
template <class... Parts>
std::string concat(const Parts&... parts) {
  std::ostringstream text;
  (text << ... << parts);
  return text.str();
}

/// "a, b, c"; empty for none.
template <class Words>
std::string listed(const Words& words) {
  std::string text;
  for (const auto& word : words) text += concat(text.empty() ? "" : ", ", word);
  return text;
}

/// The pattern filled in as printf does, cut after 255 characters.
__attribute__((format(printf, 1, 2))) inline std::string format(const char* pattern, ...) {
  char text[256];
  va_list arguments;
  va_start(arguments, pattern);
  std::vsnprintf(text, sizeof text, pattern, arguments);
  va_end(arguments);
  return text;
}

/// "1.25" for (1.25, 2); "not known" for NaN. `digits` behind the point, 0 to 9.
inline std::string fixed(double value, int digits) {
  return std::isnan(value) ? "not known" : format("%.*f", digits, value);
}

/// The message is concat(first, parts...), in the functions below too.
template <class First, class... Parts>
Status invalid_argument(const First& first, const Parts&... parts) {
  return Status(StatusCode::invalid_argument, concat(first, parts...));
}
template <class... Parts>
Status not_found(const Parts&... parts) {
  return Status(StatusCode::not_found, concat(parts...));
}
template <class... Parts>
Status corrupt(const Parts&... parts) {
  return Status(StatusCode::corrupt, concat(parts...));
}
template <class... Parts>
Status unavailable(const Parts&... parts) {
  return Status(StatusCode::unavailable, concat(parts...));
}

}  // namespace bpa
