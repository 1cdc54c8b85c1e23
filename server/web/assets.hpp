// SPDX-FileCopyrightText: 2026 The bpa authors
// SPDX-License-Identifier: Apache-2.0
#pragma once

#include <span>
#include <string_view>

namespace bpa::server::web {

/// A file of the page, compiled into the program (embed.py).
struct Asset {
  std::string_view path;  ///< Such as "/live.js".
  std::string_view type;
  std::string_view zipped;  ///< Compressed by gzip.
};

std::span<const Asset> assets();

}  // namespace bpa::server::web
